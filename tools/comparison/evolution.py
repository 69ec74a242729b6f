"""Differential evolution: the one optimiser of all laws. Same seed and budget, same result, however
many evaluations run at a time. A point that is not allowed costs infinity and nothing of the
budget."""
import math
import random

WEIGHT = (0.5, 0.9)  # of the difference, drawn anew for each trial
CROSSOVER = 0.9
MEMBERS_PER_NUMBER = 6
FEWEST_MEMBERS = 10
MOST_TRIALS = 20  # per evaluation of the budget, allowed or not


def members(numbers):
    return max(FEWEST_MEMBERS, MEMBERS_PER_NUMBER * numbers)


def reflected(value):
    """Back into 0...1 from just outside."""
    value = abs(value)
    return 2 - value if value > 1 else value


def minimise(cost_of, numbers, budget, seed):
    """The best point of the unit cube and its cost after `budget` evaluations of allowed points.

    cost_of(points) -> costs, one generation at a time; infinite where a point is not allowed.
    Yields (evaluations, best point, best cost) after every generation.
    """
    draw = random.Random(seed)
    size = min(members(numbers), budget)
    points, costs, tried = first_members(cost_of, draw, size, numbers, MOST_TRIALS * budget)
    done = sum(map(is_allowed, costs))
    while True:
        best = min(range(size), key=costs.__getitem__)
        yield done, points[best], costs[best]
        if done >= budget or tried >= MOST_TRIALS * budget:
            return
        trials = [trial(draw, points, i, best, numbers) for i in range(min(size, budget - done))]
        for i, (point, cost) in enumerate(zip(trials, cost_of(trials))):
            done += is_allowed(cost)
            if cost <= costs[i]:
                points[i], costs[i] = point, cost
        tried += len(trials)


def first_members(cost_of, draw, size, numbers, most):
    """As many allowed points as there are members, if `most` draws give them."""
    points, costs, tried = [], [], 0
    while len(points) < size and tried < most:
        drawn = latin_square(draw, size, numbers)
        tried += size
        for point, cost in zip(drawn, cost_of(drawn)):
            if is_allowed(cost) and len(points) < size:
                points.append(point)
                costs.append(cost)
    while len(points) < size:
        points.append([draw.random() for _ in range(numbers)])
        costs.append(math.inf)
    return points, costs, tried


def latin_square(draw, size, numbers):
    """Random points that cover each number's range evenly."""
    columns = []
    for _ in range(numbers):
        column = [(place + draw.random()) / size for place in range(size)]
        draw.shuffle(column)
        columns.append(column)
    return [list(point) for point in zip(*columns)]


def trial(draw, points, member, best, numbers):
    """From the member half-way towards the best, and the difference of two others."""
    others = [i for i in range(len(points)) if i != member]
    a, b = draw.sample(others, 2)
    weight = draw.uniform(*WEIGHT)
    kept = draw.randrange(numbers)  # at least this number changes
    point = []
    for n in range(numbers):
        here = points[member][n]
        if n == kept or draw.random() < CROSSOVER:
            here += 0.5 * (points[best][n] - here) + weight * (points[a][n] - points[b][n])
        point.append(min(1.0, reflected(here)))
    return point


def is_allowed(cost):
    return not math.isinf(cost)
