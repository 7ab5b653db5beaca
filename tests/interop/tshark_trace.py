#!/usr/bin/env python3
"""tshark decodes a recording of a run: every kind of message must be there, nothing malformed.

usage: tshark_trace.py TRACE [--need KIND,KIND...]

TRACE is a candump log or a pcap; KIND is one of the names printed below (default: boot-up, NMT, SDO, PDO, heartbeat).
"""
import argparse
import collections
import pathlib
import subprocess
import sys

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("trace", type=pathlib.Path)
parser.add_argument("--need", default="boot-up,NMT,SDO,PDO,heartbeat")


def kind_of(info):
    """What tshark's text about a frame says it is."""
    if info.startswith("NMT Error Control"):
        return "boot-up" if "Boot-up" in info else "heartbeat"
    for start, kind in (("NMT", "NMT"), ("Default-SDO", "SDO"), ("PDO", "PDO"), ("EMCY", "EMCY"), ("SYNC", "SYNC"),
                        ("TIME", "TIME"), ("LSS", "LSS")):
        if start in info:
            return kind
    return "other"


def main():
    args = parser.parse_args()
    needed = args.need.split(",")
    if not args.trace.is_file():
        parser.error(f"{args.trace}: no such file")
    fields = ["can.flags.rtr", "_ws.malformed", "_ws.col.Protocol", "_ws.col.Info"]
    words = ["tshark", "-r", str(args.trace), "-d", "can.subdissector,canopen", "-T", "fields"]
    for field in fields:
        words += ["-e", field]
    done = subprocess.run(words, capture_output=True, text=True, errors="replace", timeout=600)
    failures = []
    if done.returncode != 0:
        failures.append(f"tshark ended with {done.returncode}: {done.stderr.strip()[-500:]}")
    counts, malformed, frames = collections.Counter(), [], 0
    for line in done.stdout.splitlines():
        remote, broken, _, info = (line.split("\t") + [""] * len(fields))[:len(fields)]
        frames += 1
        counts["remote" if remote == "1" else kind_of(info)] += 1
        if broken or "Malformed" in info:
            malformed.append(f"frame {frames}: {info}")
    if args.trace.suffix != ".pcap":
        with args.trace.open("rb") as lines:
            recorded = sum(1 for _ in lines)
        if recorded != frames:
            failures.append(f"tshark read {frames} frames of {recorded} lines")
    for kind, count in sorted(counts.items()):
        print(f"{kind:10} {count:8}")
    print(f"{'malformed':10} {len(malformed):8}")
    failures += [f"no {kind} in the trace" for kind in needed if counts[kind] == 0]
    failures += [f"malformed {text}" for text in malformed[:10]]
    for text in failures:
        print(f"FAIL  {text}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
