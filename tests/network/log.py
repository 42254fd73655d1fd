"""A server's own log (--record), read."""
import bisect
import collections

import lcm
from tumble.messages import control_t, force_command_t, recording_t, state_t, step_record_t


class Log:
    """Everything in it by kind, in order; reading stops where liblcm's reader stops."""

    def __init__(self, path, world="TUMBLE"):
        types = {"RECORDING": recording_t, "STEP": step_record_t, "FORCE": force_command_t, "CONTROL": control_t}
        kinds = {f"{world}_{suffix}": message_type for suffix, message_type in types.items()}
        self.channels = []
        self.steps, self.commands, self.head = [], [], None
        for event in lcm.EventLog(str(path)):
            self.channels.append(event.channel.removeprefix(world + "_"))
            if event.channel not in kinds:
                continue
            message = kinds[event.channel].decode(event.data)
            if isinstance(message, recording_t):
                self.head = message
            elif isinstance(message, step_record_t):
                self.steps.append(message)
            else:
                self.commands.append(message)


class Truth:
    """Where a recording that wrote every step says that the bodies were."""

    def __init__(self, path):
        self.steps, self.positions = collections.defaultdict(list), collections.defaultdict(list)
        for event in lcm.EventLog(str(path)):
            if event.channel != "TUMBLE_STATE":
                continue
            m = state_t.decode(event.data)
            for i in range(m.n):
                self.steps[m.id[i]].append(m.step)
                self.positions[m.id[i]].append((m.px[i], m.py[i], m.pz[i]))

    def at(self, index, step):
        """The last that was written up to this step: what is not written has not changed."""
        return self.positions[index][bisect.bisect_right(self.steps[index], step) - 1]
