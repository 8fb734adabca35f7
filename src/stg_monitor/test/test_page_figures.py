"""The page at all sizes: swarms of 1 to 50, regions of 2 m to 4 km, an hour of data; and its video.

scripts/bench/bench_view.py measures times (opening, frames, lag), because they depend on the machine.
"""

import contextlib
import io
import pathlib
import shutil
import subprocess
import tempfile
import unittest
import unittest.mock

import view_fixtures
from page_case import PageCase
from stg_common.files import FileError
from stg_common.loading import load_program
from stg_view.browser import BrowserError
from stg_view.video import write_video

report = load_program(pathlib.Path(__file__).resolve().parents[1] / "scripts" / "report.py")
HOUR_MB = 50.0
# An hour of a live run of four AUVs at 10 Hz: 36,000 steps, and 432,000 rows of packets and receivers.
FEED_AN_HOUR = """
const app = STG.app, r = app.recording, types = {Float64Array: "f8", Float32Array: "f4", Int32Array: "i4", Uint8Array: "u1"};
const copy = (table, rows, times, at) => Object.keys(table.columns).map((name) => {
  const c = table.columns[name], data = new c.data.constructor(rows * c.width);
  data.set(c.data.subarray(0, Math.min(data.length, c.data.length)));
  if (times.includes(name)) for (let k = 0; k < rows; ++k) data[k] = at(k);
  if (name === "sequence") for (let k = 0; k < rows; ++k) data[k] = 1000 + Math.floor(at(k) * 40 / 3);
  return {name, type: types[data.constructor.name], width: c.width, data};
});
for (let k = arguments[0]; k < arguments[1]; k += 100) {
  r.on_steps({rows: 100}, copy(r.steps, 100, ["t"], (j) => 100 + 0.1 * (k + j)));
  r.on_packets({rows: 1200}, copy(r.packets, 1200, ["offered", "transmit", "transmit_end", "arrival"],
    (j) => 100 + 0.1 * k + 0.025 * Math.floor(j / 3)));
  ++r.version;
}
app.t = r.end;
app.took();
app.draw(performance.now());
return [r.steps.count, r.packets.count, app.transmissions.list.length, app.story.events.length];"""


class FiguresTest(PageCase):
    """Sizes of swarms, regions and memory."""

    def test_swarms_of_1_to_50_in_2_metres_and_in_4_kilometres(self):
        for agents in (1, 4, 20, 50):
            for half in (1.0, 2000.0):
                recording = view_fixtures.made_up(agents, half, steps=20, every=3, bottom=half > 10.0)
                with self.subTest(agents=agents, half=half), self.page(recording) as driver:
                    driver.execute_script("STG.app.draw(performance.now())")
                    inside = self.run_js(driver, """STG.app.scene.vehicles.filter((one) => {
                        const at = STG.app.scene.project(one.group.position.toArray()), s = STG.app.scene;
                        return at && at[0] > 0 && at[0] < s.width && at[1] > 0 && at[1] < s.height; }).length""")
                    self.assertEqual(agents, inside)
                    self.assertGreater(self.drawn(driver), 8)

    def test_what_runs_aground_joins_and_leaves_is_an_event(self):
        recording = view_fixtures.made_up(4, 100.0, bottom=True, steps=40)
        for k, row in enumerate(recording.steps.rows):
            row["aground"] = [1 if i == 1 and k in (10, 11, 20) else 2 if i == 2 and k == 15 else 0 for i in range(4)]
            if k < 5:
                row["position"][9:12] = [float("nan")] * 3
            if k >= 30:
                row["position"][0:3] = [float("nan")] * 3
        with self.page(recording) as driver:
            self.tour(driver)
            found = self.run_js(driver, "STG.app.story.events.map((e) => [e.t, e.kind, e.title])")
            wanted = [[5, "join", "auv_3 joins"], [10, "grounding", "auv_1 runs aground"],
                      [15, "grounding", "auv_2 runs into an obstacle"], [20, "grounding", "auv_1 runs aground"],
                      [30, "leave", "auv_0 leaves"]]  # fmt: skip
            self.assertEqual(wanted, [one for one in found if one[1] in ("join", "leave", "grounding")])

    def test_a_choice_of_a_target_is_an_event_and_its_line_leads_there(self):
        recording = view_fixtures.made_up(3, 100.0, steps=20)
        recording.meta["targets"] = 2
        for k, row in enumerate(recording.steps.rows):
            row["target"] = [*row["target"], 90.0, 0.0, -30.0]
            row["followed"] = [0, 1, 0 if k < 12 else 1]
        with self.page(recording) as driver:
            self.tour(driver)
            found = self.run_js(driver, "STG.app.story.events.filter((e) => e.kind === 'choice').map((e) => [e.t, e.title])")
            self.assertEqual([[12, "auv_2 turns from target 0 to target 1"]], found)
            self.assertEqual([0, 1], self.run_js(driver, "[11, 12].map((row) => STG.app.recording.targetOf(2, row))"))
            driver.execute_script("STG.app.show('table'); STG.app.seek(15); STG.app.draw(performance.now())")
            rows = self.run_js(driver, "[...document.querySelectorAll('#table tr.pick')].map((r) => r.children[2].textContent)")
            self.assertEqual(["0", "1", "1"], rows)

    def used_mb(self, driver):
        """Returns the memory of the page's objects and arrays after garbage collection [MB]."""
        driver.execute_cdp_cmd("HeapProfiler.collectGarbage", {})
        usage = driver.execute_cdp_cmd("Runtime.getHeapUsage", {})
        return (usage["usedSize"] + usage.get("backingStorageSize", 0.0)) / 1e6

    def test_an_hour_of_data_takes_less_than_50_MB(self):
        recording = view_fixtures.made_up(4, 1.0, steps=100, every=1)
        with self.page(recording) as driver:
            self.tour(driver)
            before = self.used_mb(driver)
            for begin in range(0, 36000, 3000):
                fed = driver.execute_script(FEED_AN_HOUR, begin, begin + 3000)
            steps, packets, transmissions, events = fed
            grown = self.used_mb(driver) - before
            print(f"an hour takes {grown:.1f} MB: {steps} steps, {packets} packets, {transmissions} transmissions, {events} events")
            self.assertGreater(steps, 10000)
            self.assertGreater(packets, 60000)
            self.assertLess(grown, HOUR_MB)

    @unittest.skipUnless(shutil.which("ffprobe"), "the video is not made: install ffmpeg")
    def test_a_report_films_its_page(self):
        with tempfile.TemporaryDirectory() as folder:
            run, film = pathlib.Path(folder) / "run.stgv", pathlib.Path(folder) / "run.mp4"
            run.write_bytes(view_fixtures.made_up(4).encoded())
            with contextlib.redirect_stdout(io.StringIO()):
                self.assertEqual(0, report.main([str(run), "--video", str(film), "--video-seconds", "0.5", "--video-size", "480x320"]))
            self.assertTrue(film.with_name("run.stgv.html").is_file())
            told = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-select_streams", "v:0", "-show_entries",
                                   "stream=width,height,nb_read_frames", "-of", "csv=p=0", film],
                                  capture_output=True, text=True, check=True)  # fmt: skip
            self.assertEqual("480,320,10", told.stdout.strip())

    def test_options_of_a_report_without_effect_are_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            run = pathlib.Path(folder) / "run.stgv"
            run.write_bytes(view_fixtures.made_up(4).encoded())
            for words in (["--video-seconds", "12"], ["--video-size", "1280x720"], ["--video-theme", "dark"]):
                said = io.StringIO()
                with contextlib.redirect_stderr(said), self.assertRaises(SystemExit) as ended:
                    report.main([str(run), *words])
                self.assertEqual(2, ended.exception.code)
                self.assertIn(f"{words[0]} has no effect without --video", said.getvalue())
            with self.assertRaisesRegex(FileError, "--salvage has no effect, because this is no bag"):
                report.main([str(run), "--salvage"])
            with unittest.mock.patch("shutil.which", return_value="ffmpeg"), self.assertRaisesRegex(BrowserError, "'big' is not a size"):
                report.main([str(run), "--video", "run.mp4", "--video-size", "big"])
            self.assertEqual([run], list(pathlib.Path(folder).iterdir()))

    def test_a_video_that_cannot_be_is_one_sentence(self):
        with unittest.mock.patch("shutil.which", return_value=None), self.assertRaisesRegex(BrowserError, "install ffmpeg"):
            write_video("run.html", "run.mp4", 1.0, "480x320")
        if shutil.which("ffmpeg"):
            for arguments in (("run.avi", 1.0, "480x320"), ("run.mp4", 1.0, "large"), ("run.mp4", 0.0, "480x320")):
                with self.assertRaises(BrowserError):
                    write_video("run.html", *arguments)


del PageCase  # it is no test of its own
if __name__ == "__main__":
    unittest.main()
