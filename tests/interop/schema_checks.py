"""Checks of `canopus schema`: a validator that we did not write takes every example, and refuses files with mistakes."""
import json
import tomllib

from kit import ROOT, Skip, check, command, program, require

PLANT = """[[bus]]
name = "line1"
bit_rate = 250_000
[[device]]
node = 3
eds = "encoder.eds"
"""
WRONG_PLANTS = {
    "a misspelt key": PLANT + 'strat = "1s"\n',
    "a time without a unit": PLANT + 'start = "20"\n',
    "a time without quotes": PLANT + "start = 20\n",
    "a node-ID beyond 127": PLANT.replace("node = 3", "node = 128"),
    "one table in place of several": PLANT.replace("[[device]]", "[device]"),
    "a word that is none of the choice": PLANT + '[[device.behaviour]]\nobject = "6004:00"\nkind = "sinus"\n',
    "no object": PLANT + '[[device.behaviour]]\nobject = "position"\nkind = "sine"\n',
    "a module that does not exist": PLANT + '[[plc]]\n[[plc.module]]\nmodel = "ME3CAN2"\n',
    "a table at a wrong place": PLANT + '[behaviour]\nkind = "sine"\n',
    "a bit rate that no CAN network has": PLANT.replace("250_000", "300_000"),
    "a bit rate in kbit/s": PLANT.replace("250_000", "250"),
    "text for true": PLANT + 'listen_only = "yes"\n',
}
CAMPAIGN = """[campaign]
plant = "plant.toml"
duration = "30s"
[[rule]]
name = "noise"
fault = { kind = "noise", bit_error_rate = { choose = [1e-7, 1e-6] } }
[[invariant]]
name = "up"
kind = "operational"
within = "9s"
"""
WRONG_CAMPAIGNS = {
    "a misspelt key": CAMPAIGN.replace("plant =", "plnat ="),
    "a time without a unit": CAMPAIGN.replace("30s", "30"),
    "no seeds": CAMPAIGN.replace("duration", "seeds = 0\nduration"),
    "a kind that does not exist": CAMPAIGN.replace("operational", "running"),
    "an event that does not exist": CAMPAIGN.replace('kind = "operational"', 'kind = "event"\nevent = "errors"'),
    "no table": CAMPAIGN.replace("{ kind", '"noise" #'),
    "an invariant without a name": CAMPAIGN.replace('name = "up"\n', ""),
    "one table in place of several": CAMPAIGN.replace("[[rule]]", "[rule]"),
    "a misspelt key of an invariant": CAMPAIGN.replace("within", "witihn"),
}
WRONG_NETWORKS = {
    "no node": '[[slave]]\nname = "io"\n',
    "a node-ID of 0": "[[slave]]\nnode = 0\n",
    "a misspelt key": "[[slave]]\nnode = 2\nmandatroy = true\n",
    "a word that is none of the choice": '[master]\non_error = "restart"\n[[slave]]\nnode = 2\n',
}


def validator_of(kind):
    try:
        import jsonschema
    except ImportError as missing:
        raise Skip("python3-jsonschema is not installed") from missing
    schema = json.loads(command(program, "schema", kind).stdout)
    jsonschema.Draft7Validator.check_schema(schema)
    return schema, jsonschema.Draft7Validator(schema)


def mistakes(validator, text):
    return [f"{'/'.join(map(str, error.path))}: {error.message[:200]}" for error in validator.iter_errors(tomllib.loads(text))]


@check
def schemas_take_all_examples_and_refuse_mistakes():
    """Draft 07, judged by python3-jsonschema."""
    _, plants = validator_of("plant")
    _, networks = validator_of("network")
    _, campaigns = validator_of("campaign")
    for path in sorted((ROOT / "examples").glob("*/*.toml")):
        validator = {"network.toml": networks, "campaign.toml": campaigns}.get(path.name, plants)
        found = mistakes(validator, path.read_text())
        require(not found, f"{path}: {found}")
    for validator, good in ((plants, PLANT), (campaigns, CAMPAIGN)):
        require(not mistakes(validator, good), mistakes(validator, good))
    for validator, files in ((plants, WRONG_PLANTS), (networks, WRONG_NETWORKS), (campaigns, WRONG_CAMPAIGNS)):
        for what, text in files.items():
            require(mistakes(validator, text), f"{what} is not found")


@check
def schemas_have_descriptions_choices_and_units():
    """What editors show beside a key: what the checks expect."""
    schema, _ = validator_of("plant")
    device = schema["properties"]["device"]["items"]["properties"]
    require("for example" in device["start"]["description"] and "(ns|us|ms|s|min|h)" in device["start"]["pattern"], device["start"])
    kind = device["behaviour"]["items"]["properties"]["kind"]
    require(kind["enum"] == ["sine", "ramp", "counter", "echo", "noise"], kind)
    bus = schema["properties"]["bus"]["items"]
    require(set(bus["required"]) == {"name", "bit_rate"} and "bit/s" in bus["properties"]["bit_rate"]["description"], bus)
    require(bus["properties"]["bit_rate"]["enum"] == [10000, 20000, 50000, 100000, 125000, 250000, 500000, 800000, 1000000], bus)
    fault = bus["properties"]["fault"]["items"]["properties"]
    require("bit_error_rate" in fault and "resistors" in fault, "keys of one kind of fault")
