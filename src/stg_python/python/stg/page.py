"""One HTML page of an episode, as a file or inline in a notebook: see docs/view.md."""

import html

import numpy as np

__all__ = ["Page", "report"]

PHASES = {"search": 0, "approach": 1, "stable": 2, "lost": 3}


class Page:
    """A page; a notebook shows it. `html` is its text."""

    def __init__(self, text):
        """text: HTML."""
        self.html = text

    def save(self, path):
        """Writes the page; returns the path."""
        from stg_view.page import write_page  # pylint: disable=import-outside-toplevel

        write_page(self.html, path)
        return path

    def _repr_html_(self):
        # A separate document, which cannot access the notebook's.
        return (
            f'<iframe srcdoc="{html.escape(self.html)}" sandbox="allow-scripts"'
            ' style="width:100%;height:640px;border:0"></iframe>'
        )


def report(env, path=None, title=None):
    """Returns a Page of the episode that an environment has flown up to now.

    env    a ParallelEnv made with render_mode="rgb_array", which stores its episode
    path   file for the page; None: no file
    title  of the page; None: the scenario's name
    Raises ValueError if there is no stored episode, ImportError if stg_view is not installed.
    """
    from stg_view.page import report_page  # pylint: disable=import-outside-toplevel

    history = getattr(env.unwrapped, "_history", [])
    if not history:
        raise ValueError("nothing to report: make the environment with render_mode='rgb_array', and reset it")
    title = title or env.unwrapped.scenario.name
    page = Page(report_page(recording_of(history, env.unwrapped.scenario, title), title))
    if path is not None:
        page.save(path)
    return page


def recording_of(history, scenario, title):
    """The bytes of a recording of Snapshots (see stg.render)."""
    from stg_view.recording import Recording  # pylint: disable=import-outside-toplevel

    first = history[0]
    band = scenario["reward.band_m"]
    recording = Recording(
        title=title, scenario=scenario.name, agents=len(first["position"]),
        targets=len(first["target_position"]), decision_s=scenario.decision_dt_s,
        half_extent_m=scenario["workspace.half_extent_m"], band_m=[float(x) for x in band],
        sensing_range_m=scenario["sensing.range_m"], radius_m=scenario["vehicle.radius_m"],
    )  # fmt: skip
    recording.add("episode", episode=0, start=float(first["time"]))
    for shot in history:
        distance, error, lost = (shot["tracking"][:, k] for k in (0, 1, 3))
        near = (distance >= band[0]) & (distance <= band[1])
        phase = np.where(lost > 0.5, PHASES["lost"], np.where(near, PHASES["stable"], PHASES["approach"]))
        recording.steps.add(
            t=shot["time"], position=shot["position"].ravel(), heading=shot["rpy"][:, 2], pitch=-shot["rpy"][:, 1],
            phase=phase, distance=distance, estimate=shot["estimate"].ravel(), target=shot["target_position"].ravel(),
            tracking_error=error,
        )  # fmt: skip
    return recording.encoded()
