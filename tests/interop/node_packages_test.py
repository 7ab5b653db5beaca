"""The npm packages of the checks are installed once, and again where other versions are wanted."""
import json
import os
import pathlib
import sys

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import node_packages  # noqa: E402


class Npm:
    """Installs what the folder asks for, or fails."""

    def __init__(self, folder, error=None):
        self.folder, self.error, self.calls = folder, error, 0
        self.want("1.0.0")

    def want(self, version):
        (self.folder / "package.json").write_text(json.dumps({"dependencies": {"canopen": version}}))

    def __call__(self, words):
        self.calls += 1
        assert words[0] == "ci"  # as the lock file has it
        if self.error:
            raise RuntimeError(self.error)
        package = self.folder / "node_modules/canopen"
        package.mkdir(parents=True, exist_ok=True)
        wanted = json.loads((self.folder / "package.json").read_text())["dependencies"]["canopen"]
        (package / "package.json").write_text(json.dumps({"version": wanted}))


@pytest.fixture
def run_folder(tmp_path):
    folder = tmp_path / "run"
    folder.mkdir()
    return folder


def test_packages_are_installed_once_for_all_checks(tmp_path, run_folder):
    npm = Npm(tmp_path)
    for _ in range(3):
        node_packages.install(tmp_path, run_folder, npm)
    assert npm.calls == 1


def test_packages_of_another_version_are_installed_again(tmp_path, run_folder):
    npm = Npm(tmp_path)
    node_packages.install(tmp_path, run_folder, npm)
    npm.want("1.0.1")
    node_packages.install(tmp_path, run_folder, npm)
    assert npm.calls == 2


def test_an_install_that_fails_is_tried_once_in_a_run(tmp_path, run_folder):
    npm = Npm(tmp_path, error="npm ci: no network")
    for _ in range(3):
        with pytest.raises(RuntimeError, match="npm ci: no network"):
            node_packages.install(tmp_path, run_folder, npm)
    assert npm.calls == 1


def test_a_registry_that_is_out_of_reach_is_no_failure_of_the_checks(tmp_path, run_folder):
    npm = Npm(tmp_path, error="npm error code EAI_AGAIN\nnpm error request to https://registry.npmjs.org/canopen failed")
    for _ in range(2):
        with pytest.raises(node_packages.NoRegistry, match="EAI_AGAIN"):
            node_packages.install(tmp_path, run_folder, npm, pauses=(0, 0))
    assert npm.calls == 3
    npm = Npm(tmp_path, error="npm error code EINTEGRITY")
    (run_folder / "npm-failure").unlink()
    with pytest.raises(RuntimeError, match="EINTEGRITY"):
        node_packages.install(tmp_path, run_folder, npm)


def test_the_next_run_tries_an_install_again(tmp_path, run_folder):
    npm = Npm(tmp_path, error="npm ci: no network")
    with pytest.raises(RuntimeError):
        node_packages.install(tmp_path, run_folder, npm)
    npm.error = None
    next_run = tmp_path / "next"
    next_run.mkdir()
    node_packages.install(tmp_path, next_run, npm)
    assert node_packages.is_installed(tmp_path)


def test_a_file_is_old_when_one_of_its_sources_was_changed_after_it(tmp_path):
    source, made = tmp_path / "page", tmp_path / "packages.json"
    for file in (source / "index.html", source / "src/main.ts", source / "test/views.test.ts", made):
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("")
        os.utime(file, (1000, 1000))
    os.utime(made, (2000, 2000))
    assert not node_packages.is_newer(source, made)
    os.utime(source / "test/views.test.ts", (3000, 3000))
    assert node_packages.is_newer(source, made) and not node_packages.is_newer(source, made, but=("test",))
    os.utime(source / "src/main.ts", (3000, 3000))
    assert node_packages.is_newer(source, made, but=("test",))
