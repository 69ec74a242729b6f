"""The settings that a resonance asks for."""
import dataclasses
from typing import TYPE_CHECKING

from .dictionary import Value
from .resonance import ENABLED, default_bandwidth_rad_s, number, put_back, switch_off
from .resonance_curve import NONE, Resonance

if TYPE_CHECKING:
    from .drive import Drive

UNKNOWN_SHARE, LEAST_PERCENT = 0.3, 5  # of the inertia, before a stiff belt
CURRENT_OVER_LAW = 4.0                 # bandwidths: loop_bandwidth.h
MOST_BANDWIDTH_rad_s = 750.0           # that has been tried


@dataclasses.dataclass(frozen=True)
class Proposal:
    settings: dict[str, Value]  # nothing: they stay as they are
    reason: str

    def __str__(self) -> str:
        return "\n".join([*(f"{name} = {value:g}" for name, value in self.settings.items()), f"  {self.reason}"])

    def apply(self, drive: "Drive") -> None:
        """Enabled, it is switched off for it."""
        enabled = drive.state in ENABLED
        if enabled:
            switch_off(drive)
        put_back(drive, self.settings, enabled)


def propose(drive: "Drive", found: Resonance, rotor_inertia_kgm2: float | None = None) -> Proposal:
    """`rotor_inertia_kgm2`: of the data sheet."""
    settings = drive.settings
    if found.resonance_Hz is None:
        if found.verdict != NONE:
            return Proposal({}, "nothing: that there is none is not sure")
        return _of_a_rigid_machine(drive)
    inertia_kgm2, percent = number(settings["inertia_kgm2"]), number(settings["rotor_inertia_percent"])
    if rotor_inertia_kgm2 is not None:
        share, reason = rotor_inertia_kgm2 / inertia_kgm2, f"rotor inertia over inertia_kgm2, {inertia_kgm2:g} kg m2"
    elif found.rotor_share is not None:
        share, reason = found.rotor_share, "antiresonance over resonance, squared, less what detent torque adds"
    else:
        share, reason = min(UNKNOWN_SHARE, percent / 100), "the rotor's share is not known, and rather too little holds; " \
            "--rotor-inertia of the data sheet says more"
    asked = {"rotor_inertia_percent": float(min(max(round(100 * share), LEAST_PERCENT), 100))}
    in_force_rad_s, default_rad_s = number(settings["law_bandwidth_rad_s"]), default_bandwidth_rad_s(drive)
    with_it_rad_s = 0.01 * asked["rotor_inertia_percent"] * default_rad_s
    given = abs(in_force_rad_s / (0.01 * percent * default_rad_s) - 1) > 0.01
    if given and in_force_rad_s > 1.01 * with_it_rad_s:
        asked["law_bandwidth_rad_s"] = with_it_rad_s  # it does not heed the percentage
    return Proposal(dict(asked), reason)


def _of_a_rigid_machine(drive: "Drive") -> Proposal:
    settings = drive.settings
    most_rad_s = min(number(settings["current_bandwidth_rad_s"]) / CURRENT_OVER_LAW, MOST_BANDWIDTH_rad_s)
    in_force_rad_s = 0.01 * number(settings["rotor_inertia_percent"]) * default_bandwidth_rad_s(drive)
    if settings["law"] != "state-feedback" or most_rad_s <= max(in_force_rad_s, number(settings["law_bandwidth_rad_s"])):
        return Proposal({}, "nothing: the law has the bandwidth of a rigid machine")
    return Proposal({"law_bandwidth_rad_s": most_rad_s}, "may be tried: a rigid machine bears a quarter of "
                    "current_bandwidth_rad_s, and there is no more without more of that")
