"""The cases of a saved campaign, made anew from its texts, and its key figures."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from analytic.errors import LinkproofError
from comparisons.campaign.campaign import CampaignRequest, cases
from comparisons.campaign.results import Results
from comparisons.campaign.standards import checksum
from comparisons.judging.baseline import Baseline, regime_key
from comparisons.judging.baseline import Place as BaselinePlace
from comparisons.judging.records import Record
from comparisons.reference.case import Case

Place = tuple[str, str, str]  # mechanism, variant and regime


def saved_cases(results: Results) -> dict[Place, Case]:
    """The case of every record; raises LinkproofError where a text cannot be read, or its linkage cannot move."""
    table = {record.run[:3]: None for record in results.records}
    prescribed = {motion.regime for motion in results.motions}
    own_regimes = tuple(dict.fromkeys(regime for _, _, regime in table if regime not in prescribed))
    conditions = results.document["conditions"]
    request = CampaignRequest(results.linkages, results.motions, conditions, engines=(), own_regimes=own_regimes)
    result = {(c.mechanism.linkage.name, c.mechanism.linkage.variant, c.motion.regime): c for c in cases(request)}
    for place in table.keys() - result.keys():
        raise LinkproofError(f"expected the motion of {'/'.join(place)} in the folder, got none: it is damaged")
    return {place: result[place] for place in table}


def saved_figures(results: Results) -> dict[Place, dict[str, float]]:
    """The key figures of a folder, SI, by name; empty for results of another tool."""
    groups: dict[Place, dict[str, float]] = {}
    for figure in results.figures:
        if figure.now is not None:
            groups.setdefault((figure.mechanism, figure.variant, figure.regime), {})[figure.figure] = figure.now
    return groups


def as_baseline(
    results: Results, figures: Mapping[Place, Mapping[str, float]], records: Iterable[Record] = ()
) -> Baseline:
    """Key figures, and records where there are any, of a campaign as a baseline for others."""
    conditions = {record.run[:3]: record.conditions for record in results.records}
    places = {linkage.name: BaselinePlace(linkage.name, checksum(linkage.text)) for linkage in results.linkages}
    keyed = {(p[0], p[1], regime_key(p[2], conditions[p])): values for p, values in figures.items() if p in conditions}
    return Baseline({}, places).recorded(records, keyed)
