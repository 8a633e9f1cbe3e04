"""What holds for every test: random cases are the same ones each time."""

import hypothesis

pytest_plugins = ["tests.deadlines"]
hypothesis.settings.register_profile("repeatable", derandomize=True, deadline=None)
hypothesis.settings.load_profile("repeatable")
