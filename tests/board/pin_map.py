"""Reads a pin map of a port and compares its pins with an independent description of the chip."""

import re


def without_comments(text):
    return re.sub(r"/\*.*?\*/", lambda m: re.sub(r"[^\n]", "", m.group()), text, flags=re.DOTALL)


# one pin behind the other, as hal.h has their bits
MACHINE = {"MACHINE_INPUTS": ("LIMIT_MINUS", "LIMIT_PLUS", "HOME", "ENABLE", "QUICK_STOP"),
           "MACHINE_OUTPUTS": ("ALARM", "IN_POSITION", "HOLDING_BRAKE")}


class PinMap:
    """pins: (pin, mode, alternate function, pull, peripheral, signal); comparators: (number,
    input); whatever else is defined, as text, by name: map["BAUD"]."""

    def __init__(self, path):
        self.path = path
        text = without_comments(path.read_text(encoding="utf-8")).replace("\\\n", " ")
        self.pins = [
            (f"P{port}{number}", *rest)
            for port, number, *rest in re.findall(
                r"PIN\((\w), (\d+), (\w+), (\d+), (\w+), (\w+), (\w+)\)", text
            )
        ]
        self.comparators = [
            (int(number), int(given))
            for number, given in re.findall(r"COMPARATOR\((\d+), (\d+)\)", text)
        ]
        self.defined = {
            name: value.strip()
            for name, value in re.findall(r"^#define (\w+)[ \t]+(.+)$", text, re.MULTILINE)
        }
        self.at = {(peripheral, signal): pin for pin, _, _, _, peripheral, signal in self.pins}

    def __getitem__(self, name):
        return self.defined[name]

    def number(self, name):
        return int(self.defined[name])

    def integrated(self):
        return self.defined.get("BRIDGE", "BRIDGE_INTEGRATED") == "BRIDGE_INTEGRATED"

    def differences(self, facts):
        """Of every pin from what the chip has there."""
        used = [pin for pin, *_ in self.pins]
        for pin in sorted({pin for pin in used if used.count(pin) > 1}):
            yield f"{pin} has two uses"
        for pin, mode, function, _, peripheral, signal in self.pins:
            expected = function if mode == "ALTERNATE" else "-"
            if mode not in ("OUTPUT", "INPUT") and (peripheral, pin, signal, expected) not in facts.pins:
                yield f"{pin}: no {peripheral} {signal} with function {expected} there"
        gates = [f"CH{n}" for n in (1, 2, 3, 4)]
        if not self.integrated():
            gates += [f"{gate}N" for gate in gates]
        needed = [("TIM1", gate) for gate in gates] + [("LPUART1", "TX"), ("LPUART1", "RX")]
        yield from (f"no pin for {' '.join(which)}" for which in needed if which not in self.at)
        if self.defined.get("CAN_BIT_Hz", "0") != "0":
            yield from (f"CAN_BIT_Hz: no pin for FDCAN3 {which}" for which in ("TX", "RX")
                        if ("FDCAN3", which) not in self.at)
        outputs = {"BRIDGE_RESET": "RESET"} if self.integrated() else {}
        for name, signal in {
            **outputs,
            **({"BRAKE": "BRAKE"} if self.defined.get("HAS_BRAKE") == "1" else {}),
            **({"LED": "LED"} if "LED_PIN" in self.defined else {}),
        }.items():
            port, number = self[f"{name}_PORT"], self[f"{name}_PIN"]
            if self.at.get((port, signal)) != f"P{port[-1]}{number}":
                yield f"{name}_PORT, {name}_PIN: {port} {number} is no pin with signal {signal}"
        for name, signals in MACHINE.items():
            if name + "_PIN" not in self.defined:
                continue
            port, first = self[name + "_PORT"], int(self[name + "_PIN"])
            for at, signal in enumerate(signals):
                if self.at.get((port, signal)) != f"P{port[-1]}{first + at}":
                    yield f"{name}_PIN: {port} {first + at} is no pin with signal {signal}"

    def channels_without_pin(self, converters):
        """`converters`: {name of a channel's definition: converter}"""
        for name, converter in converters.items():
            if (converter, f"IN{self[name]}") not in self.at:
                yield f"{name}: no pin leads to {converter} IN{self[name]}"
