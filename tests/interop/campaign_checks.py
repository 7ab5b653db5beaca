"""Campaigns on many machines: what schedulers that we did not write make of the how-to."""
import re
import shutil

from kit import HERE, ROOT, Skip, check, command, node_modules, program, require, scratch

CAMPAIGN = f"""[campaign]
plant = "{ROOT}/examples/first-plant/plant.toml"
duration = "2s"
seeds = 24
[[rule]]
name = "encoder loses its supply"
device = "encoder"
power_cut = {{ at = {{ low = "1200ms", high = "1500ms" }}, for = "100ms" }}
[[invariant]]
name = "an encoder boots once"
kind = "frames"
after = "1200ms"
filter = "service=error-control boot-up node=3"
"""


@check
def the_kubernetes_job_of_the_how_to_is_valid():
    node_modules()
    job = ROOT / "examples/campaign/cluster/job.yaml"
    command("node", HERE / "kubernetes_job.mjs", job)
    text = job.read_text()
    for before, after in (("completions: 16", "completions: all"), ("restartPolicy: OnFailure", "restartPolicy: []"), ("template:", "templates:")):
        require(before in text, before)
        wrong = scratch / "wrong.yaml"
        wrong.write_text(text.replace(before, after))
        require("data/spec" in command("node", HERE / "kubernetes_job.mjs", wrong, expect=1).stderr, after)


@check
def gnu_parallel_runs_a_campaign_as_the_how_to_says():
    """Its line, with two log-ins of this machine, and a shard that is killed once."""
    if not shutil.which("parallel"):
        raise Skip("parallel is not installed")
    (scratch / "night.toml").write_text(CAMPAIGN)
    (scratch / "machines.txt").write_text(":\n1/:\n")
    page = (ROOT / "docs/how-to/campaigns-on-many-machines.md").read_text()
    line = re.search(r"\$ (parallel .*?) ::: ", page, re.DOTALL).group(1).replace("\\\n", " ").replace("64", "4")
    killed = line.replace("canopus campaign", "[ {#} != 2 ] || [ -e killed ] || { touch killed; kill -9 $$; }; canopus campaign")
    require(killed != line, line)
    bin_folder = scratch / "bin"
    bin_folder.mkdir()
    (bin_folder / "canopus").symlink_to(program)
    command("bash", "-c", f"export PATH={bin_folder}:$PATH; {killed} ::: $(seq 4)", cwd=scratch)
    require((scratch / "killed").exists(), "no shard was killed")
    command(program, "campaign", "report", "night.results", cwd=scratch, expect=1)
    command(program, "campaign", "night.toml", "--results", "alone", cwd=scratch, expect=1)
    require((scratch / "alone/results.jsonl").read_bytes() == (scratch / "night.results/results.jsonl").read_bytes(), "other results")
