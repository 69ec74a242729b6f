"""What the checks of the structure have in common."""
import pathlib
import sys


def report(found, what="violations"):
    """Prints them; the exit status."""
    for text in found:
        print(text)
    print(f"{len(found)} {what}")
    return 1 if found else 0


def of_root(usage, violations, self_test, arguments, what="violations"):
    """A check called with the project's root, or with --self-test before it: the exit status."""
    if len(arguments) == 2 and arguments[0] == "--self-test":
        return 0 if self_test(pathlib.Path(arguments[1])) else 1
    if len(arguments) != 1:
        print(usage, file=sys.stderr)
        return 2
    return report(list(violations(pathlib.Path(arguments[0]))), what)
