"""What each part of the default law is worth: the law with that part taken away."""

from comparison.results import Entry

# What is taken away, and the settings that take it away.
PARTS = [
    ("no feed-forward", {"drive.feed_forward": False}),
    ("no jerk feed-forward", {"drive.law_gains.jerk_feed_forward": 0.0}),
    ("no load compensation", {"drive.law_gains.load_compensation": 0.0}),
    ("no voltage-disturbance observer", {"drive.law_gains.voltage_disturbance_rad_s": 0.0}),
    ("no detent learning", {"drive.detent_learning": False}),
    ("no bridge-loss compensation", {"drive.bridge_loss_compensation": False}),
]


def entries_of(base):
    """The law as it is, then without one part each."""
    return [base] + [Entry(title, base.law, base.parameters, "", {**base.settings, **settings})
                     for title, settings in PARTS]
