"""AUVs that fly at each time: members that leave a swarm and join it again (fleet.leave, fleet.join)."""

__all__ = ["Members"]


class Members:
    """The lives of the AUVs of a scenario, by decision.

    AUV i is the agent "auv_<i>". An AUV that has left and joins again is another agent, whose name
    ends in the number of its life, "auv_<i>_2", because an agent must not come back after its end.
    """

    def __init__(self, scenario):
        """Reads the rows of `scenario`."""
        self._period = scenario.decision_dt_s
        events = [(row[0], int(row[1]), False) for row in scenario["fleet.leave"]]
        # If a leave and a join have the same time, the join counts, as in the engine.
        events += [(row[0], int(row[1]), True) for row in scenario["fleet.join"]]
        self.changes = bool(events)
        self._lives = [self._lives_of(i, sorted(events)) for i in range(scenario.agents)]
        self.names = [name for lives in self._lives for name, *_ in lives]
        self.auv = {name: i for i, lives in enumerate(self._lives) for name, *_ in lives}

    @staticmethod
    def _lives_of(auv, events):
        """[name, begin, end] of each life [s]; the end is None if the AUV never leaves."""
        lives, there = [[f"auv_{auv}", 0.0, None]], True
        for time, who, joins in events:
            if who != auv or joins == there:
                continue
            there = joins
            if joins:
                lives.append([f"auv_{auv}_{len(lives) + 1}", time, None])
            else:
                lives[-1][2] = time
        return lives

    def at(self, decision):
        """Names of the agents that fly at a decision, in the order of the AUVs."""
        t = decision * self._period
        flying = []
        for lives in self._lives:
            flying += [n for n, begin, end in lives if begin <= t and (end is None or t < end)]
        return flying
