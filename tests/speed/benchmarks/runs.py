"""A run of an engine and its judging: the Juki needle mechanism under the published ramp."""

from __future__ import annotations

import dataclasses

from . import lacking


def _case():
    motion = lacking.module("analytic.description.crank_motion").crank_motion("run-up")
    return lacking.module("comparisons.case").Case(lacking.mechanism("juki-mf7923d"), motion)


def _run(engine):
    """The engine, its tuned setting and a scene in which everything but joint forces is recorded."""
    setting, channel = lacking.module("engines.contract").Setting, lacking.module("engines.scene").Channel
    adapter = lacking.module("engines.registry").engine(engine)
    if adapter.version() is None:
        raise NotImplementedError(f"{engine} is not installed")
    scene = _case().scene(frozenset(channel) - {channel.JOINT_FORCE})
    return adapter, setting.TUNED, scene


class Tuned:
    """One tuned run, set-up and read-out included."""

    params = ("direct", "exudyn", "pymunk")
    param_names = ("engine",)

    def setup(self, engine):
        self.adapter, self.setting, self.scene = _run(engine)

    def time_run(self, _engine):
        return self.adapter.run(self.scene, self.setting).history.torque.values


class Judging:
    """Deviations of every quantity that is a result, and the invariants, of one tuned run; the truth made anew."""

    params = ("exudyn",)
    param_names = ("engine",)

    def setup(self, engine):
        adapter, setting, self.scene = _run(engine)
        self.observed = lacking.module("comparisons.observed_motion").ObservedMotion
        self.deviation = lacking.module("comparisons.judging.quantities").deviation
        self.quantities = lacking.module("comparisons.judging.quantities").chosen_quantities
        self.checks = lacking.module("comparisons.invariants.checks").checks
        record = lacking.module("comparisons.judging.records").Record
        words = {field.name: "" for field in dataclasses.fields(record) if field.default is dataclasses.MISSING}
        self.blank = record(**{**words, "setting": "tuned", "regime": "run-up"})
        self.history = adapter.run(self.scene, setting).history

    def time_deviations(self, _engine):
        case, motion = _case(), self.observed(self.scene, self.history)
        quantities = self.quantities(case, ("Jeq", "Teq", "Mkr", "Peq", "S", "v", "a"))
        return [self.deviation(case, quantity, motion).error_max for quantity in quantities]

    def time_invariants(self, _engine):
        motion = self.observed(self.scene, self.history)
        return [record.samples for record in self.checks(_case(), motion, self.blank)]
