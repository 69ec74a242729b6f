"""One call of a program: (code, out, err, files), or a text if it does not end.

Workers of a cluster get these functions with the call. They need no other module of ours and hand
back plain values, because a class of this module would be another one there.
"""
import io
import os
import pathlib
import subprocess
import tempfile
import zipfile

LONGEST_CALL_s = 900  # some hundred times what it takes
PROGRAM = "steadystep-sil"
CATALOGUE = pathlib.Path(__file__).resolve().parent.parent.parent / "sil"  # where the tools are


def write_files(folder, files):
    """`files`: text by name, which may have folders in it."""
    for name, text in files.items():
        file = pathlib.Path(folder, name)
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")


def answer_of(command, folder, returns):
    """Of `command` in `folder`, with the text of those files of `returns` that are there."""
    try:
        done = subprocess.run([str(word) for word in command], cwd=folder, capture_output=True,
                              text=True, check=False, timeout=LONGEST_CALL_s)
    except subprocess.TimeoutExpired:
        return f"{' '.join(map(str, command))}: no end after {LONGEST_CALL_s} s"
    here = pathlib.Path(folder or ".")
    return (done.returncode, done.stdout, done.stderr,
            {name: (here / name).read_text(encoding="utf-8") for name in returns
             if (here / name).is_file()})


def bundle_of(program, catalogue):
    """The program, with its scenarios, motors and parameter sets beside it, as one archive."""
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as bundle:
        bundle.write(program, PROGRAM)
        for folder in ("scenarios", "motors", "parameters"):
            for file in sorted((catalogue / folder).rglob("*")):
                if file.is_file():
                    bundle.write(file, str(file.relative_to(catalogue)))
    return archive.getvalue()


def unpacked(parts, name):
    """Folder of the bundle on this machine; whoever comes first unpacks it."""
    home = pathlib.Path(tempfile.gettempdir(), f"{PROGRAM}-{os.getuid()}-{name}")
    if not home.is_dir():
        aside = pathlib.Path(tempfile.mkdtemp(prefix=f"{PROGRAM}-"))
        zipfile.ZipFile(io.BytesIO(b"".join(parts))).extractall(aside)
        (aside / PROGRAM).chmod(0o755)
        try:
            aside.rename(home)
        except OSError:  # another worker was quicker
            if not home.is_dir():
                raise
    return home


def same(value):
    return value


def run_bundled(parts, name, arguments, files, returns):
    """On a worker: the answer of the bundle's program."""
    home = unpacked(parts, name)
    with tempfile.TemporaryDirectory() as folder:
        write_files(folder, files)
        answer = answer_of([home / PROGRAM, *arguments], folder, returns)
    if isinstance(answer, str):
        return answer
    code, out, err, left = answer
    return code, out, err.replace(f"{home}/", ""), left
