"""Linkages with something left out, to see what engines build less for them."""

from dataclasses import replace

from analytic.description.changes import LOADS, without
from analytic.description.linkage import Slot


def without_gravity(linkage):
    """The linkage where nothing weighs anything."""
    return without(linkage, "gravity")


def without_loads(linkage):
    """The linkage without forces, torques, springs and dampers; its weight stays."""
    return without(linkage, *LOADS)


def with_bare_slots(linkage, sliders):
    """The linkage with a pin in a slot in place of each of these sliders, which are nothing but a mass there."""
    pins = [replace(pin, links=tuple(name for name in pin.links if name not in sliders)) for pin in linkage.pins]
    slots = [Slot(slider.point, slider.guide) for slider in linkage.sliders if slider.link in sliders]
    return replace(
        linkage,
        links={name: link for name, link in linkage.links.items() if name not in sliders},
        pins=tuple(pin for pin in pins if len(pin.links) > 1),
        sliders=tuple(slider for slider in linkage.sliders if slider.link not in sliders),
        slots=(*linkage.slots, *slots),
    )
