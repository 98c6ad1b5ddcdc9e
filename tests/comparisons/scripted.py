"""An engine that returns what a test makes of a scene, and remembers what it was asked."""

from engines.contract import Abilities, ReadOut
from engines.scene import Channel


class Scripted:
    """``act`` gives the run of a scene and a setting, or of a scene, a method and a step, s."""

    def __init__(self, act, *, name="scripted", version="1.0", channels=tuple(Channel), methods=(), is_control=False):
        self.act, self.name, self.is_control = act, name, is_control
        self._version, self._methods = version, methods
        readouts = {channel: ReadOut("scripted") for channel in channels}
        self.abilities = Abilities(readouts, frozenset(), frozenset(), frozenset())
        self.asked = []

    def version(self):
        return self._version

    def methods(self, scene):
        return self._methods

    def run(self, scene, setting):
        self.asked.append(setting)
        return self.act(scene, setting)

    def run_method(self, scene, method, step):
        self.asked.append((method.name, step))
        return self.act(scene, method, step)
