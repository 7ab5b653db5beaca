"""The npm packages of all checks: one folder, one lock file, installed once, whichever check of whichever run needs them first."""
import contextlib
import fcntl
import json


@contextlib.contextmanager
def one_at_a_time(folder):
    """Checks run side by side, and so may runs; what they do to the folder's packages in here, they do one after the other."""
    with (folder / "package-lock.json").open() as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def install(folder, run_folder, npm):
    """Makes `folder`/node_modules what `folder`/package.json says, by `npm(words)`, which raises where that fails. Checks of one run,
    whose folder is `run_folder`, try it once: the others fail with the same words."""
    if is_installed(folder):
        return
    failure = run_folder / "npm-failure"
    if failure.exists():
        raise RuntimeError(failure.read_text())
    try:
        # What is optional are serial ports.
        npm(["ci", "--no-audit", "--no-fund", "--ignore-scripts", "--omit=optional"])
    except Exception as error:
        failure.write_text(str(error))
        raise


def is_installed(folder):
    wanted = json.loads((folder / "package.json").read_text())["dependencies"]
    return all(version_of(folder / "node_modules" / name) == version for name, version in wanted.items())


def version_of(package):
    try:
        return json.loads((package / "package.json").read_text())["version"]
    except (OSError, ValueError):
        return None
