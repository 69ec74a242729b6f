"""The states of CiA 402."""
from canopen.profiles.p402 import State402

BRIDGE_ON = ("SWITCHED ON", "OPERATION ENABLED", "QUICK STOP ACTIVE", "FAULT REACTION ACTIVE")


def state_of(status: int) -> str:
    """The state in a statusword."""
    for name, (mask, bits) in State402.SW_MASK.items():
        if status & mask == bits:
            return str(name)
    return "UNKNOWN"
