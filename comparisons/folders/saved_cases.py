"""What a saved campaign gives to those who judge it: its cases, made anew from its texts, and its key figures."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from analytic.errors import LinkproofError
from comparisons.campaign.campaign import CampaignRequest, cases
from comparisons.campaign.key_figures import key_figures
from comparisons.campaign.results import Results
from comparisons.campaign.standards import checksum
from comparisons.judging.baseline import Baseline, regime_key
from comparisons.judging.baseline import Place as BaselinePlace
from comparisons.judging.records import Record
from comparisons.reference.case import Case

Place = tuple[str, str, str]  # mechanism, variant and regime


def saved_cases(results: Results) -> dict[Place, Case]:
    """Each case that a record tells of; raises LinkproofError where a text cannot be read, or cannot move."""
    asked = {record.run[:3]: None for record in results.records}
    prescribed = {motion.regime for motion in results.motions}
    own = tuple(dict.fromkeys(regime for _, _, regime in asked if regime not in prescribed))
    conditions = results.document["conditions"]
    request = CampaignRequest(results.linkages, results.motions, conditions, engines=(), own_regimes=own)
    found = {(c.mechanism.linkage.name, c.mechanism.linkage.variant, c.motion.regime): c for c in cases(request)}
    for place in asked.keys() - found.keys():
        raise LinkproofError(f"expected the motion of {'/'.join(place)} in the folder, got none: it is damaged")
    return {place: found[place] for place in asked}


def saved_figures(results: Results, made: Mapping[Place, Case]) -> dict[Place, dict[str, float]]:
    """The key figures that a folder tells, SI, by name; of one that tells none those of its cases."""
    if "figures" not in results.document:
        return {place: key_figures(case) for place, case in made.items()}
    found: dict[Place, dict[str, float]] = {}
    for one in results.figures:
        if one.now is not None:
            found.setdefault((one.mechanism, one.variant, one.regime), {})[one.figure] = one.now
    return found


def as_baseline(
    results: Results, figures: Mapping[Place, Mapping[str, float]], records: Iterable[Record] = ()
) -> Baseline:
    """Key figures, and records where there are any, of a campaign as the baseline that others are held to."""
    conditions = {record.run[:3]: record.conditions for record in results.records}
    places = {linkage.name: BaselinePlace(linkage.name, checksum(linkage.text)) for linkage in results.linkages}
    keyed = {(p[0], p[1], regime_key(p[2], conditions[p])): told for p, told in figures.items() if p in conditions}
    return Baseline({}, places).recorded(records, keyed)
