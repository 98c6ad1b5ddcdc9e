"""A linkage file simulated in absolute coordinates with Lagrange's multipliers, in NumPy alone.

It shares nothing with the closed form: the file is read as plain TOML, positions come from Newton's method on the
joints' equations, velocities and accelerations from their derivatives, torque and joint forces from the multipliers.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

SI = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254, "kg": 1.0, "g": 1e-3, "lb": 0.45359237, "rad": 1.0,
      "deg": np.pi / 180.0, "kg*m^2": 1.0, "kg*mm^2": 1e-6, "g*mm^2": 1e-9, "g*m^2": 1e-3}  # fmt: skip
GROUND, STEPS, STARTS = "ground", 240, 200  # of a turn, of the assembly
Array = np.ndarray
Motion = Callable[[Array], tuple[Array, Array, Array]]  # times (n,), s: angle, speed, acceleration of the crank


class AssemblyError(Exception):
    """A linkage that cannot be assembled or does not turn fully."""


def _turned(c: Array, s: Array, vector: Array) -> Array:
    return np.stack([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]], axis=-1)


class Multibody:
    """Bodies with three coordinates each; ``branch`` is the assembly, the nearest to the sketch is 0."""

    def __init__(self, file: Mapping[str, Any], branch: int = 0) -> None:
        units = file["units"]
        self.length, self.angle = SI[units["length"]], SI[units["angle"]]
        mass, inertia = SI[units["mass"]], SI[units["inertia"]]
        self.file, self.names = file, list(file["links"])
        self.rows = {name: 3 * number for number, name in enumerate(self.names)}
        self.points = {
            n: {p: self._place(at) for p, at in k.get("points", {}).items()} for n, k in file["links"].items()
        }
        for name, link in file["links"].items():
            if "slides" in link:
                self.points[name].setdefault(link["slides"]["point"], np.zeros(2))
        self.points[GROUND] = {p: self._place(at) for p, at in file.get("ground", {}).items()}
        self.mass = [mass * k.get("mass", 0.0) for k in file["links"].values()]
        self.inertia = [inertia * k.get("inertia", 0.0) for k in file["links"].values()]
        self.centre = [self._place(k.get("centre", (0.0, 0.0))) for k in file["links"].values()]
        self.size = max(float(np.max(np.abs(p))) for k in self.points.values() for p in k.values())
        self.joints = list(self._joints())
        self.highest: float | None = None
        self.begin = self.angle * file["sketch"].get("angle", 0.0)
        self.turn = self._traced(self._assembled(branch))

    def _place(self, at: Any) -> Array:
        if isinstance(at, Mapping):
            turn = self.angle * at["angle"]
            about = np.array(at.get("about", (0.0, 0.0)))
            return self.length * (about + at["radius"] * np.array([np.cos(turn), np.sin(turn)]))
        return self.length * np.array(at, dtype=float)

    def _joints(self):
        """Name, kind, the two bodies and their data; the force of a joint acts on the first body."""
        carriers: dict[str, list[str]] = {}
        for body in (GROUND, *self.names):
            for point in self.points[body]:
                carriers.setdefault(point, []).append(body)
        for point, bodies in carriers.items():
            hub = GROUND if GROUND in bodies else min(bodies)
            others = [body for body in bodies if body != hub]
            for body in others:
                name = point if len(others) == 1 else f"{point}:{body}"
                yield name, "pin", body, hub, (self.points[body][point], self.points[hub][point])
        for name, link in self.file["links"].items():
            if (slide := link.get("slides")) is not None:
                host = slide.get("on", GROUND)
                yield f"{name} on {host}", "slide", name, host, (self.points[name][slide["point"]], *self._line(slide))
        for slot in self.file.get("slots", ()):
            host = slot.get("on", GROUND)
            body = next(b for b in carriers[slot["point"]] if b != host)
            yield (
                f"{slot['point']} in {host}",
                "slot",
                body,
                host,
                (self.points[body][slot["point"]], *self._line(slot)),
            )

    def _line(self, line: Mapping[str, Any]) -> tuple[Array, Array]:
        along = np.array(line["along"], dtype=float)
        return self._place(line["through"]), along / np.hypot(*along)

    def at(self, q: Array, body: str, local: Array) -> tuple[Array, Array]:
        """A point's place (n, 2) and its derivatives by the coordinates (n, 2, 3 bodies)."""
        slopes = np.zeros((*q.shape[:1], 2, q.shape[1]), dtype=q.dtype)
        if body == GROUND:
            return np.broadcast_to(local.astype(q.dtype), (len(q), 2)), slopes
        row = self.rows[body]
        arm = _turned(np.cos(q[:, row + 2]), np.sin(q[:, row + 2]), local)
        slopes[:, 0, row] = slopes[:, 1, row + 1] = 1.0
        slopes[:, 0, row + 2], slopes[:, 1, row + 2] = -arm[:, 1], arm[:, 0]
        return q[:, row : row + 2] + arm, slopes

    def _direction(self, q: Array, body: str, local: Array) -> tuple[Array, Array]:
        place, slopes = self.at(q, body, local)
        origin, other = self.at(q, body, np.zeros(2))
        return place - origin, slopes - other

    def equations(self, q: Array, phi: Array) -> tuple[Array, Array]:
        """What the joints leave open (n, m), the crank's angle last, and its derivatives (n, m, m)."""
        rest, slopes = [], []
        for _, kind, body, host, data in self.joints:
            place, of_place = self.at(q, body, data[0])
            other, of_other = self.at(q, host, data[1])
            gap, of_gap = place - other, of_place - of_other
            if kind == "pin":
                rest += [gap[:, 0], gap[:, 1]]
                slopes += [of_gap[:, 0], of_gap[:, 1]]
                continue
            normal, of_normal = self._direction(q, host, np.array([-data[2][1], data[2][0]]))
            rest.append(np.sum(normal * gap, axis=1))
            slopes.append(np.einsum("ni,nij->nj", normal, of_gap) + np.einsum("ni,nij->nj", gap, of_normal))
            if kind == "slide":
                turn, of_turn = q[:, self.rows[body] + 2].copy(), np.zeros_like(slopes[-1])
                of_turn[:, self.rows[body] + 2] = 1.0
                if host != GROUND:
                    turn = turn - q[:, self.rows[host] + 2]
                    of_turn[:, self.rows[host] + 2] = -1.0
                rest.append(turn - np.arctan2(data[2][1], data[2][0]))
                slopes.append(of_turn)
        crank = self.rows[self.file["crank"]] + 2
        of_crank = np.zeros_like(slopes[-1])
        of_crank[:, crank] = 1.0
        rest.append(q[:, crank] - phi)
        slopes.append(of_crank)
        return np.stack(rest, axis=1), np.stack(slopes, axis=1)

    def _closed(self, q: Array, phi: Array, rounds: int) -> tuple[Array, Array]:
        """Coordinates that close the joints, by Newton's method, and what is left open (n,)."""
        for _ in range(rounds):
            rest, slopes = self.equations(q, phi)
            q = q - np.linalg.solve(slopes, rest[..., None])[..., 0]
        return q, np.max(np.abs(self.equations(q, phi)[0]), axis=1)

    def _assembled(self, branch: int) -> Array:
        sketch = self.file["sketch"]
        random, phi = np.random.default_rng(7), np.full(STARTS, self.angle * sketch.get("angle", 0.0))
        q = np.empty((STARTS, 3 * len(self.names)))
        q[:, 0::3], q[:, 1::3] = random.uniform(-2.0, 2.0, (2, STARTS, len(self.names))) * self.size
        q[:, 2::3] = random.uniform(-np.pi, np.pi, (STARTS, len(self.names)))
        with np.errstate(all="ignore"):
            try:
                q, gap = self._closed(q, phi, 25)
            except np.linalg.LinAlgError as error:
                raise AssemblyError("singular") from error
        q = q[gap < 1e-10 * self.size]
        if not len(q):
            raise AssemblyError("no assembly")
        distance = np.zeros(len(q))
        for point, at in sketch.get("points", {}).items():
            body = next(b for b in self.names if point in self.points[b])
            distance += np.sum((self.at(q, body, self.points[body][point])[0] - self._place(at)) ** 2, axis=1)
        order, branches = np.argsort(distance, kind="stable"), []
        for one in q[order]:
            turns = one.copy()
            turns[2::3] = (one[2::3] + np.pi) % (2.0 * np.pi) - np.pi
            if all(np.max(np.abs(np.exp(1j * turns[2::3]) - np.exp(1j * b[2::3]))) > 1e-6 for b in branches):
                branches.append(turns)
        if branch >= len(branches):
            raise AssemblyError("no such assembly")
        return branches[branch]

    @property
    def _grid(self) -> Array:
        return self.begin + np.linspace(0.0, 2.0 * np.pi, STEPS + 1)

    def _traced(self, start: Array) -> Array:
        """Coordinates (steps + 1, m) over one turn, from a start at the sketch's angle."""
        known = [start]
        for last, angle in itertools.pairwise(self._grid):
            q = known[-1][None]
            drive = np.zeros((1, q.shape[1], 1))
            drive[0, -1] = angle - last
            q = q + np.linalg.solve(self.equations(q, np.array([last]))[1], drive)[..., 0]
            q, gap = self._closed(q, np.array([angle]), 3)
            if not gap[0] < 1e-6 * self.size or np.max(np.abs(q[0] - known[-1])[2::3]) > 0.7:
                raise AssemblyError("does not turn fully")
            known.append(q[0])
        turn = np.array(known)
        if np.max(np.abs(np.exp(1j * turn[-1, 2::3]) - np.exp(1j * turn[0, 2::3]))) > 1e-6:
            raise AssemblyError("changes its assembly")
        return turn

    def positions(self, phi: Array) -> Array:
        """Coordinates (n, m) at crank angles, from the nearest of the turn."""
        whole = self.turn[-1] - self.turn[0]  # of every coordinate over a turn
        place = (phi - self.begin) / (2.0 * np.pi)
        number = np.floor(place)
        near = np.rint((place - number) * STEPS).astype(int)
        q, gap = self._closed(self.turn[near] + number[:, None] * whole, phi, 5)
        if not np.max(gap) < 1e-9 * (self.size + np.max(np.abs(phi))):
            raise AssemblyError("joints open")
        return q

    def curves(self, time: Array, motion: Motion) -> dict[str, Array]:
        """Signals (n,), SI, by the names that linkproof has for them."""
        phi, speed, acceleration = motion(time)
        q = self.positions(phi)
        _, slopes = self.equations(q, phi)
        drive = np.zeros_like(q)
        drive[:, -1] = speed
        v = np.linalg.solve(slopes, drive[..., None])[..., 0]
        step = 1e-30
        bent = self.equations(q + 1j * step * v, phi)[1].imag / step
        right = -np.einsum("nij,nj->ni", bent, v)
        right[:, -1] += acceleration
        a = np.linalg.solve(slopes, right[..., None])[..., 0]
        loads = self._loads(q, v, a)
        multipliers = np.linalg.solve(np.swapaxes(slopes, 1, 2), -loads[..., None])[..., 0]
        found = {"phi": phi, "omega": speed, "Mkr": multipliers[:, -1]}
        for name, row in self.rows.items():
            found |= {f"link:{name}:angle": q[:, row + 2], f"link:{name}:omega": v[:, row + 2]}
        row = 0
        for name, kind, body, *_ in self.joints:
            count = {"pin": 2, "slide": 2, "slot": 1}[kind]
            lines = slopes[:, row : row + count, self.rows[body] : self.rows[body] + 2]
            force = np.einsum("nk,nkj->nj", multipliers[:, row : row + count], lines)
            found |= {f"joint_force:{name}:x": force[:, 0], f"joint_force:{name}:y": force[:, 1]}
            row += count
        if (output := self.file.get("output")) is not None:
            found |= self._output(output, q, v, a)
        return found

    def _moving(self, q: Array, v: Array, a: Array, body: str, local: Array) -> tuple[Array, Array, Array]:
        """Place, velocity and acceleration of a point, (n, 2) each."""
        place, slopes = self.at(q, body, local)
        turning = np.zeros((len(q), 1)) if body == GROUND else v[:, self.rows[body] + 2, None]
        origin = place if body == GROUND else q[:, self.rows[body] : self.rows[body] + 2]
        centripetal = -(turning**2) * (place - origin)
        return place, np.einsum("nij,nj->ni", slopes, v), np.einsum("nij,nj->ni", slopes, a) + centripetal

    def _highest(self, body: str, local: Array, along: Array) -> float:
        """The farthest place of the output over a turn: about it ever more closely, then the top of a parabola."""
        if self.highest is None:
            angles = np.linspace(0.0, 2.0 * np.pi, 721)
            for width in (0.01, 1e-4, 0.0):
                places = self.at(self.positions(angles), body, local)[0] @ along
                best = int(np.clip(np.argmax(places), 1, len(places) - 2))
                before, here, after = places[best - 1 : best + 2]
                angles = np.linspace(angles[best] - width, angles[best] + width, 201)
            self.highest = float(here + (after - before) ** 2 / (8.0 * (2.0 * here - before - after)))
        return self.highest

    def _output(self, output: Mapping[str, Any], q: Array, v: Array, a: Array) -> dict[str, Array]:
        body = next(b for b in self.names if output["point"] in self.points[b])
        local = self.points[body][output["point"]]
        line = output.get("along") or next(
            k["slides"]["along"]
            for k in self.file["links"].values()
            if k.get("slides", {}).get("point") == output["point"]
        )
        along = np.array(line) / np.hypot(*line)
        high = self._highest(body, local, along)
        place, speed, acceleration = (x @ along for x in self._moving(q, v, a, body, local))
        return {"S": high - place, "v": -speed, "a": -acceleration}

    def _loads(self, q: Array, v: Array, a: Array) -> Array:
        """Inertia forces and loads along the coordinates, (n, m)."""
        total = np.zeros_like(q)
        gravity = np.array(self.file.get("gravity", (0.0, 0.0)), dtype=float)

        def push(body: str, local: Array, force: Array) -> None:
            total[:] += np.einsum("ni,nij->nj", force, self.at(q, body, local)[1])

        for name, mass, inertia, centre in zip(self.names, self.mass, self.inertia, self.centre, strict=True):
            push(name, centre, mass * (gravity - self._moving(q, v, a, name, centre)[2]))
            total[:, self.rows[name] + 2] -= inertia * a[:, self.rows[name] + 2]
        for load in self.file.get("forces", ()):
            body = load.get("link") or next(b for b in self.names if load["point"] in self.points[b])
            push(body, self.points[body][load["point"]], np.broadcast_to(np.array(load["force"], float), (len(q), 2)))
        for load in self.file.get("torques", ()):
            total[:, self.rows[load["link"]] + 2] += load["torque"]
        for spring in self.file.get("springs", ()):
            first, second = spring["between"]
            ends = [
                (b, self.points[b][p])
                for p in (first, second)
                for b in [next(b for b in (*spring.get("links", ()), *self.names, GROUND) if p in self.points[b])]
            ]
            (here, rate, _), (there, other, _) = (self._moving(q, v, a, *end) for end in ends)
            span = there - here
            length = np.hypot(*span.T)[:, None]
            unit = span / length
            speed = np.sum((other - rate) * unit, axis=1, keepdims=True)
            pull = spring["stiffness"] * (length - self.length * spring["length"]) + spring.get("damping", 0.0) * speed
            for (body, local), side in zip(ends, (1.0, -1.0), strict=True):
                push(body, local, side * pull * unit)
        for damper in self.file.get("dampers", ()):
            one, two = (np.zeros(len(q)) if b == GROUND else v[:, self.rows[b] + 2] for b in damper["between"])
            for body, side in zip(damper["between"], (-1.0, 1.0), strict=True):
                if body != GROUND:
                    total[:, self.rows[body] + 2] += side * damper["coefficient"] * (one - two)
        return total
