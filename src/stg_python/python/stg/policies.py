"""Policy files: flown by agents, written from networks that were trained elsewhere."""

import numpy as np

from stg import _core
from stg.scenarios import load_scenario, override_texts
from stg.vector import seed_of

__all__ = ["evaluate", "export_policy", "load_policy"]


def load_policy(path):
    """Returns the Policy of an ONNX file.

    policy.mean(observations [..., K]) gives actions [..., A]. Raises UserError for anything but a
    policy; a file cannot run code.
    """
    return _core.Policy.load(str(path))


def evaluate(policy, scenario="medium", condition="nominal", overrides=None, episodes=30,
             seed=3000, workers=1, privileged=False):  # fmt: skip
    """Returns {metric: mean, metric_std: standard deviation} over whole episodes.

    policy: a file or a built-in controller's name. Episode e is drawn from seed + e. The numbers are
    those of the command line `evaluate`. privileged: a built-in controller reads true states.
    """
    s = load_scenario(scenario, condition, overrides)
    return _core.evaluate(
        str(policy), s, episodes, seed_of(seed), workers, privileged, override_texts(overrides)
    )


def _flat(module):
    """Yields the innermost modules of a torch.nn.Sequential, in their order."""
    children = list(module.children())
    if not children:
        yield module
    for child in children:
        yield from _flat(child)


def _layers(module):
    """Returns ([(weight, bias)], activation) of Linear, (Tanh | ReLU), ..., Linear, Tanh."""
    parts = list(_flat(module))
    names = [type(part).__name__ for part in parts]
    hidden = set(names[1:-1:2])
    if (
        len(parts) % 2
        or set(names[::2]) != {"Linear"}
        or names[-1] != "Tanh"
        or len(hidden) > 1
        or not hidden <= {"Tanh", "ReLU"}
    ):
        raise ValueError(
            "a policy is Linear, Tanh, ..., Linear, Tanh (or ReLU between the layers, Tanh at the "
            f"end), not {', '.join(names)}"
        )
    layers = []
    for linear in parts[::2]:
        weight = linear.weight.detach().cpu().numpy().astype(np.float32)
        bias = np.zeros(len(weight), np.float32)
        if linear.bias is not None:
            bias = linear.bias.detach().cpu().numpy().astype(np.float32)
        layers.append((weight, bias))
    return layers, "relu" if hidden == {"ReLU"} else "tanh"


def _check(policy, module, mean, std, clip, scale):
    """Raises ValueError unless the policy and the module give the same actions."""
    import torch  # pylint: disable=import-outside-toplevel

    seen = np.random.default_rng(0).normal(size=(64, len(mean))).astype(np.float32) * std + mean
    normal = np.clip((seen - mean) / std, -clip, clip)
    parameter = next(module.parameters())
    with torch.no_grad():
        wanted = module(torch.as_tensor(normal, dtype=parameter.dtype, device=parameter.device))
    error = np.abs(policy.mean(seen) - scale * wanted.cpu().numpy()).max()
    if not error < 1e-4:
        raise ValueError(f"actions of the file would differ from the module's by {error:.3g}")


def export_policy(
    torch_module, path, scenario, *, observation_mean=None, observation_std=None,
    observation_clip=10.0, log_std=None, action_scale=1.0, id="policy",  # pylint: disable=W0622
    training_step=0, seed=0, metrics=None,
):  # fmt: skip
    """Writes a policy file that agents, `evaluate` and the graph accept; returns its Policy.

    torch_module      a torch.nn.Sequential of Linear, Tanh, ..., Linear, Tanh (or ReLU between);
                      it maps normalised observations [rows, K] to actions [rows, A]
    scenario          the one it was trained in, a name or a Scenario: gives layout and interface
    observation_mean, observation_std [K], observation_clip
                      the normaliser: clip((observation - mean) / std, +-clip); default none
    log_std           [A] natural log of the standard deviations it explored with; default 0
    action_scale      in (0, 1], multiplies the module's output
    id                name for logs and recorded steps
    training_step     environment steps it was trained for
    seed              of the training
    metrics           {name: text or number} for people

    Raises ValueError for another module, or if the file would give other actions (tried on 64
    observations), UserError for sizes that do not fit the scenario.
    """
    s = load_scenario(scenario)
    layers, activation = _layers(torch_module)
    size = layers[0][0].shape[1]
    mean = np.zeros(size) if observation_mean is None else observation_mean
    std = np.ones(size) if observation_std is None else observation_std
    mean, std = (np.asarray(x, np.float32).reshape(-1) for x in (mean, std))
    policy = _core.Policy(
        layers,
        input_mean=mean,
        input_std=std,
        input_clip=float(observation_clip),
        activation=activation,
        log_std=None if log_std is None else np.asarray(log_std, np.float32).reshape(-1),
        observation_layout=s.observation_layout,
        action_interface=s.action_interface,
        action_scale=float(action_scale),
        id=str(id),
        scenario_hash=s.hash,
        training_step=int(training_step),
        seed=seed_of(seed),
        metrics={str(k): str(v) for k, v in (metrics or {}).items()},
    )
    policy.require_fits(s)
    _check(policy, torch_module, mean, std, np.float32(observation_clip), np.float32(action_scale))
    policy.save(str(path))
    return policy
