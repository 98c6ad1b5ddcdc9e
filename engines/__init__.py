"""Third-party multibody engines behind one small contract."""
