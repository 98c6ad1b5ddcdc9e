"""The mechanics of a scene: rigid bodies in the plane, the joints as equations between them, the loads on them."""
