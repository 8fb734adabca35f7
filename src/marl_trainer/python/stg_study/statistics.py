"""Means, deviations, interquartile means, comparisons of trainings, bootstrap intervals."""

import numpy as np

TRIM = 0.25  # share that the interquartile mean cuts off at each end
RESAMPLES = 2000
FINAL_SHARE = 0.2  # of the validations of a training


def mean_std(values):
    """Mean and sample standard deviation. The deviation of a single value is None."""
    values = np.asarray(values, dtype=float)
    return float(values.mean()), float(values.std(ddof=1)) if values.size > 1 else None


def interquartile_mean(values, axis=-1):
    """Mean of the middle half: a quarter, rounded down, is cut off at each end."""
    values = np.sort(np.asarray(values, dtype=float), axis=axis)
    cut = int(TRIM * values.shape[axis])
    middle = np.arange(cut, values.shape[axis] - cut)
    return np.take(values, middle, axis=axis).mean(axis=axis)


def iqm_interval(scores, resamples=RESAMPLES, confidence=0.95, seed=0):
    """Interquartile mean over runs and its stratified bootstrap interval (Agarwal et al. 2021).

    scores[condition] is [seeds, episodes], with the same seeds in each. The score of a run under a condition
    is the mean of its episodes, and the middle half of all these scores is averaged. A resample draws seeds,
    the same ones in every condition, because they belong to one training run. With one seed there is no
    interval, and its ends are the mean.

    Returns (interquartile mean, lower end, upper end), percentiles of the resamples.
    """
    strata = [np.asarray(stratum, dtype=float) for stratum in scores]
    seeds = strata[0].shape[0]
    if any(stratum.ndim != 2 or stratum.shape[0] != seeds for stratum in strata):
        raise ValueError("every condition needs scores of the same seeds, [seeds, episodes]")
    runs = np.array([stratum.mean(axis=1) for stratum in strata])  # [conditions, seeds]
    random = np.random.default_rng(seed)
    drawn = random.integers(seeds, size=(resamples, seeds))
    values = interquartile_mean(runs[:, drawn].transpose(1, 0, 2).reshape(resamples, -1))
    tail = 100.0 * (1.0 - confidence) / 2.0
    low, high = np.percentile(values, [tail, 100.0 - tail])
    return float(interquartile_mean(runs.ravel())), float(low), float(high)


def paired_interval(ours, theirs, resamples=2 * RESAMPLES, confidence=0.95, seed=0):
    """Mean of ours - theirs over episodes that both flew, and its bootstrap interval over episodes.

    If one of them has more episodes, its first ones are compared. Returns (mean, lower end, upper end).
    """
    count = min(len(ours), len(theirs))
    difference = np.asarray(ours[:count], dtype=float) - np.asarray(theirs[:count], dtype=float)
    random = np.random.default_rng(seed)
    means = difference[random.integers(count, size=(resamples, count))].mean(axis=1)
    tail = 100.0 * (1.0 - confidence) / 2.0
    low, high = np.percentile(means, [tail, 100.0 - tail])
    return float(difference.mean()), float(low), float(high)


def hierarchical_interval(ours, theirs, resamples=RESAMPLES, confidence=0.95, seed=0):
    """Mean of ours - theirs and its interval by a bootstrap over trainings and then over episodes.

    ours and theirs are [trainings, episodes]; a controller counts as one training. All flew the same
    episodes, and a resample draws the same ones for both sides. If one of them has more episodes, its first
    ones are compared. Returns (mean, lower end, upper end).
    """
    count = min(len(values) for values in (*ours, *theirs))
    ours, theirs = (np.array([v[:count] for v in side], dtype=float) for side in (ours, theirs))
    random = np.random.default_rng(seed)
    draws = max(len(ours), len(theirs))
    means = []
    for _ in range(resamples):
        episodes = random.integers(count, size=(draws, count))
        first = random.integers(len(ours), size=(draws, 1))
        second = random.integers(len(theirs), size=(draws, 1))
        means.append((ours[first, episodes] - theirs[second, episodes]).mean())
    tail = 100.0 * (1.0 - confidence) / 2.0
    low, high = np.percentile(means, [tail, 100.0 - tail])
    return float(ours.mean() - theirs.mean()), float(low), float(high)


def probability_of_improvement(ours, theirs, resamples=RESAMPLES, confidence=0.95, seed=0):
    """Probability that one of our trainings scores more than one of theirs, and its bootstrap interval.

    ours[condition] and theirs[condition] are scores of trainings, one for each seed; the numbers of seeds may
    differ. Mean over conditions of P(x > y) + P(x = y) / 2 over all pairs (Agarwal et al. 2021, Eq. 3). A
    resample draws trainings again, the same ones in every condition.

    Returns (probability, lower end, upper end).
    """
    ours, theirs = np.asarray(ours, dtype=float), np.asarray(theirs, dtype=float)
    if ours.ndim != 2 or theirs.ndim != 2 or len(ours) != len(theirs):
        raise ValueError("scores must be [conditions, seeds], of the same conditions")
    difference = ours[:, :, None] - theirs[:, None, :]
    better = ((difference > 0.0) + 0.5 * (difference == 0.0)).mean(axis=0)
    random = np.random.default_rng(seed)
    rows = random.integers(ours.shape[1], size=(resamples, ours.shape[1]))
    columns = random.integers(theirs.shape[1], size=(resamples, theirs.shape[1]))
    values = better[rows[:, :, None], columns[:, None, :]].mean(axis=(1, 2))
    tail = 100.0 * (1.0 - confidence) / 2.0
    low, high = np.percentile(values, [tail, 100.0 - tail])
    return float(better.mean()), float(low), float(high)


def performance_profile(scores, thresholds):
    """Share of the scores, of any shape, that are above each threshold (Agarwal et al. 2021)."""
    scores = np.asarray(scores, dtype=float).ravel()
    return (scores[None, :] > np.asarray(thresholds, dtype=float)[:, None]).mean(axis=1)


def final_stage(points, share=FINAL_SHARE):
    """The last `share` of a list of evaluation points, at least one of them."""
    if not points:
        raise ValueError("a curve needs at least one point")
    return points[-max(1, int(round(share * len(points)))) :]
