"""Tables of mechanisms hold what they should."""

from analytic.description.loading import catalogue, literature, load
from reports.document.terminal import rendered
from reports.mechanism import terminal


def test_catalogue_names_its_mechanisms():
    sewing, others = ([load(name) for name in names] for names in (catalogue(), literature()))
    text = rendered(*terminal.catalogue({"Sewing": sewing, "Linkages of the literature": others, "Nothing": []}))
    assert all(linkage.name in text for linkage in sewing + others)
    assert "Nothing" not in text
    assert text.index(sewing[-1].name) < text.index("Linkages of the literature") < text.index(others[0].name)
