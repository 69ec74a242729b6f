"""Packs what an image copies to RAM at its start; hal/cortex_m/unpack.h has the format.

Whole numbers throughout: the same bytes wherever it runs.
"""

import struct

PROBABILITY_BITS = 12
ADAPTATION = 4  # a model moves by 1/16 of what it was wrong by
TOP = 1 << 24  # below it, the range takes in another byte
LONGEST = 255
CANDIDATES = 64  # earlier places that a match is looked for at
PASSES = 3  # each counts by what the one before has learned

CALL = 0x1E  # of a BL the first bits; of its second half these and one more

WIDE = 0xE8  # an instruction of two halves begins with a byte from here on
EVEN_PLACE, CONTEXTS = 12, 14  # of a literal: two of even places, twelve of odd ones

MATCH, AGAIN, LITERAL = "match", "again", "literal"


def gamma(name, value):
    """(model, bit) of a number from 1 on: how many bits follow its first, then these."""
    bits = value.bit_length() - 1
    for place in range(bits):
        yield (name, place), 1
    yield (name, bits), 0
    for place in range(bits - 1, -1, -1):
        yield (name, bits, place), value >> place & 1


def context(data, at):
    """By the byte that says what the instruction before does; an odd place says what its own does."""
    odd = at & 1
    before = data[at - 1 - odd] if at > odd else 0
    if not odd:
        return EVEN_PLACE + (before >= WIDE)
    return before >> 2 & 7 if before < WIDE else 8 + (before >> 2 & 3)


def literal(context_of_it, byte):
    node = 1
    for place in range(7, -1, -1):
        bit = byte >> place & 1
        yield (LITERAL, context_of_it, node), bit
        node = 2 * node + bit


def length_bits(length, again):
    return gamma(("length", again), length if again else length - 1)


def distance_bits(distance, length):
    return gamma(("distance", length > 2), distance)


class RangeCoder:
    """Carries as LZMA's does."""

    def __init__(self):
        self.low, self.range = 0, 0xFFFFFFFF
        self.held, self.pending = 0, 1  # a byte that a carry may yet change, and 0xff behind it
        self.out = bytearray()
        self.models = {}
        self.counts = {}

    def put(self, bits):
        for model, bit in bits:
            probability = self.models.get(model, 1 << PROBABILITY_BITS - 1)
            self.counts.setdefault(model, [0, 0])[bit] += 1
            bound = (self.range >> PROBABILITY_BITS) * probability
            if bit:
                self.low += bound
                self.range -= bound
                self.models[model] = probability - (probability >> ADAPTATION)
            else:
                self.range = bound
                more = (1 << PROBABILITY_BITS) - probability
                self.models[model] = probability + (more >> ADAPTATION)
            while self.range < TOP:
                self.range = self.range << 8 & 0xFFFFFFFF
                self.shift()

    def shift(self):
        if self.low < 0xFF000000 or self.low > 0xFFFFFFFF:
            carry = self.low >> 32
            self.out.append(self.held + carry & 0xFF)
            self.out.extend([0xFF + carry & 0xFF] * (self.pending - 1))
            self.held, self.pending = self.low >> 24 & 0xFF, 0
        self.pending += 1
        self.low = (self.low & 0xFFFFFF) << 8

    def end(self):
        for _ in range(5):
            self.shift()
        return bytes(self.out[1:])  # the first is the carry that never comes


def sixteenths(numerator, denominator):
    """-log2 of a fraction, in sixteenths of a bit."""
    power = (denominator**16 * 65536) // max(numerator, 1) ** 16
    return power.bit_length() - 1 - 16


class Prices:
    """What each bit would cost by the counts of a pass, in sixteenths."""

    def __init__(self, counts):
        self.of_bit = {
            model: [sixteenths(2 * n + 1, 2 * sum(both) + 2) for n in both]
            for model, both in counts.items()
        }
        self.literals = [[self.sum(literal(c, byte)) for byte in range(256)] for c in range(CONTEXTS)]
        self.lengths = [
            [0] * 2 + [self.sum(length_bits(n, again)) for n in range(2, LONGEST + 1)]
            for again in range(2)
        ]
        self.lengths[1][1] = self.sum(length_bits(1, 1))
        self.distances = {}

    def sum(self, bits):
        return sum(self.bit(model, bit) for model, bit in bits)

    def bit(self, model, bit):
        return self.of_bit.get(model, (16, 16))[bit]

    def distance(self, distance, length):
        key = distance, length > 2
        if key not in self.distances:
            self.distances[key] = self.sum(distance_bits(distance, length))
        return self.distances[key]


def common(data, i, j, known=0):
    """How far the bytes from i and j on are the same."""
    length, most = known, min(LONGEST, len(data) - j)
    while length < most and data[i + length] == data[j + length]:
        length += 1
    return length


def earlier_matches(data):
    """By place: [(distance, longest match)], nearer first, each longer than those before."""
    places = {}
    found = []
    for at in range(len(data)):
        longest, here = 1, []
        pair = data[at : at + 2]
        triple = data[at : at + 3]
        for start in (places.get(pair, ())[-1:], places.get(triple, ())[: -CANDIDATES - 1 : -1]):
            for i in start:
                if data[i : i + longest] == data[at : at + longest]:
                    length = common(data, i, at, longest)
                    if length > longest:
                        here.append((at - i, length))
                        longest = length
        found.append(here)
        if len(pair) == 2:
            places.setdefault(pair, []).append(at)
        if len(triple) == 3:
            places.setdefault(triple, []).append(at)
    return found


def cheapest(data, matches, prices):
    """[(length, distance)]; distance 0: a literal. Shortest path over the places."""
    size = len(data)
    cost = [1 << 60] * (size + 1)
    step = [(0, 0)] * (size + 1)
    state = [(0, 0)] * (size + 1)  # (distance last used, whether a match was last)
    cost[0] = 0

    def reach(to, price, length, distance, last):
        if price < cost[to]:
            cost[to], step[to] = price, (length, distance)
            state[to] = last, int(distance > 0)

    for at in range(size):
        last, matched = state[at]
        parity = at & 1
        kind = [cost[at] + prices.bit((MATCH, parity, matched), bit) for bit in range(2)]
        reach(at + 1, kind[0] + prices.literals[context(data, at)][data[at]], 1, 0, last)
        if 0 < last <= at:
            price = kind[1] + prices.bit((AGAIN, matched), 1)
            for length in range(1, common(data, at - last, at) + 1):
                reach(at + length, price + prices.lengths[1][length], length, last, last)
        price = kind[1] + prices.bit((AGAIN, matched), 0)
        shortest = 2
        for distance, longest in matches[at]:
            for length in range(shortest, longest + 1):
                dear = price + prices.lengths[0][length] + prices.distance(distance, length)
                reach(at + length, dear, length, distance, distance)
            shortest = longest + 1
    path = []
    while size > 0:
        path.append(step[size])
        size -= step[size][0]
    return path[::-1]


def put_region(coder, data, path):
    at, last, matched = 0, 0, 0
    for length, distance in path:
        coder.put([((MATCH, at & 1, matched), int(distance > 0))])
        if distance == 0:
            coder.put(literal(context(data, at), data[at]))
        else:
            again = int(distance == last)
            coder.put([((AGAIN, matched), again)])
            coder.put(length_bits(length, again))
            if not again:
                coder.put(distance_bits(distance, length))
            last = distance
        matched = int(distance > 0)
        at += length


def with_destinations(data):
    """With each call by its destination, place_calls() of unpack.c."""
    halves = list(struct.unpack_from(f"<{len(data) // 2}H", data))
    at = 0
    while at + 1 < len(halves):
        first, second = halves[at : at + 2]
        if first >> 11 == CALL and second >> 11 == CALL | 1:
            to = ((first & 0x7FF) << 11 | second & 0x7FF) + at
            halves[at : at + 2] = first & 0xF800 | to >> 11 & 0x7FF, second & 0xF800 | to & 0x7FF
            at += 1
        at += 1
    return struct.pack(f"<{len(halves)}H", *halves) + data[2 * len(halves) :]


def pack(regions):
    """The bytes that unpack() makes `regions` of, one after the other."""
    regions = [with_destinations(data) for data in regions]
    matches = [earlier_matches(data) for data in regions]
    prices = Prices({(MATCH, p, m): [3, 1] for p in range(2) for m in range(2)})
    for _ in range(PASSES):
        coder = RangeCoder()
        for data, found in zip(regions, matches):
            put_region(coder, data, cheapest(data, found, prices))
        prices = Prices(coder.counts)
    return coder.end()
