"""Ends a trainer node by a signal, for the tests of all packages."""

import re
import subprocess
import threading


def learn_and_stop(program, folder, parameters, limit_s=40.0):
    """Runs a trainer node until its first update and ends it by SIGTERM.

    Fails unless the node then ends with status 0 and has kept the update.

    Args:
        program: path of trainer_node.
        folder: pathlib.Path of the training (the parameter ~out).
        parameters: further words of the command line, such as `__name:=trainer`.
        limit_s: wall time after which the node is killed [s].

    Returns:
        What the node printed.
    """
    with subprocess.Popen(
        [program, f"_out:={folder}"] + list(parameters),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        universal_newlines=True,
    ) as trainer:
        limit = threading.Timer(limit_s, trainer.kill)
        limit.start()
        text = ""
        for line in trainer.stdout:
            text += line
            if line.startswith("update"):
                trainer.terminate()
        limit.cancel()
    if trainer.returncode != 0:
        raise AssertionError(f"the trainer ended with status {trainer.returncode}:\n{text}")
    if not re.search(r"trainer: stopped after [1-9]\d* updates", text):
        raise AssertionError(f"the trainer did not report its updates:\n{text}")
    if not list(folder.glob("checkpoint_*.ckpt")) or not (folder / "policy_last.onnx").exists():
        raise AssertionError(f"{folder} does not hold the training:\n{text}")
    return text
