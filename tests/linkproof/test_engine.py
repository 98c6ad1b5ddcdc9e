"""The contract for plug-ins has a name for everything that an adapter is made of."""

import linkproof
from engines import contract, scene


def test_each_of_its_names_is_there():
    assert all(hasattr(linkproof.engine, name) for name in linkproof.engine.__all__)
    assert sorted(linkproof.engine.__all__) == linkproof.engine.__all__


def test_no_class_of_contract_or_scene_is_left_out():
    made = {
        name
        for module in (contract, scene)
        for name, value in vars(module).items()
        if isinstance(value, type) and value.__module__ == module.__name__
    }
    assert made - set(linkproof.engine.__all__) <= {"GuidedJoint"}  # what slider and slot have in common
