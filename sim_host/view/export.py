#!/usr/bin/env python3
"""All signals of a trial, a row a tick, with units and provenance, for the tools of others: CSV, Parquet, MCAP."""
import argparse
import io
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from serve import EXIT_USAGE  # noqa: E402

NEEDS = {"csv": (), "json": (), "parquet": (("pyarrow", "pyarrow"),), "mcap": (("mcap", "mcap"),)}


def provenance(walk):
    told = {key: value for key, value in walk.told.items() if key not in ("subject", "parameters")}
    return {"trial": walk.name, **told, "person": walk.subject["person"], "device": walk.subject["device"],
            "made_by": f"afo report --export, {walk.subject['version']}", "parameters": walk.subject["parameters"]}


def units():
    import signals
    return {"tick": "", "time": "s", **{one["name"]: one["unit"] for one in signals.descriptions()}}


def to_csv(walk):
    """A line of names, then rows: a plain pandas.read_csv loads it. An empty field says that there is none."""
    import signals
    text = io.StringIO()
    text.write(",".join(["tick", "time", *signals.NAMES]) + "\n")
    times = walk.sync_us / 1e6
    for tick, (time, row) in enumerate(zip(times.tolist(), walk.rows.tolist())):
        values = ",".join("" if value != value else f"{value:.7g}" for value in row)
        text.write(f"{tick},{time:.6f},{values}\n")
    return text.getvalue().encode()


def to_json(walk):
    """What stands beside the CSV file: provenance, units and events."""
    return (json.dumps({**provenance(walk), "units": units(), "events": walk.events}, indent=1, default=str) + "\n").encode()


def to_parquet(walk):
    import pyarrow
    import pyarrow.parquet
    import numpy as np
    import signals
    unit = units()
    columns = {"tick": np.arange(len(walk.rows), dtype=np.int64), "time": walk.sync_us / 1e6,
               **{name: walk.rows[:, place] for place, name in enumerate(signals.NAMES)}}
    help_of = {one["name"]: one["help"] for one in signals.descriptions()}
    fields = [pyarrow.field(name, pyarrow.from_numpy_dtype(values.dtype),
                            metadata={"unit": unit[name], "meaning": help_of.get(name, "")}) for name, values in columns.items()]
    schema = pyarrow.schema(fields, metadata={"provenance": json.dumps(provenance(walk), default=str),
                                              "events": json.dumps(walk.events, default=str)})
    sink = io.BytesIO()
    pyarrow.parquet.write_table(pyarrow.table([pyarrow.array(v) for v in columns.values()], schema=schema), sink)
    return sink.getvalue()


def to_mcap(walk):
    """A topic for each group of signals and one for the events, as JSON with its schema."""
    import signals
    from mcap.writer import Writer
    sink = io.BytesIO()
    writer = Writer(sink)
    writer.start(profile="", library="afo")
    writer.add_metadata("provenance", {key: json.dumps(value, default=str) for key, value in provenance(walk).items()})
    described = signals.descriptions()
    stamps = (walk.sync_us * 1000).tolist()
    for group in dict.fromkeys(one["group"] for one in described):
        chosen = [(signals.INDEX[one["name"]], one) for one in described if one["group"] == group]
        properties = {one["name"]: {"type": ["number", "null"], "description": f"{one['help']} [{one['unit']}]"} for _, one in chosen}
        channel = _channel(writer, f"/afo/{group}", {"type": "object", "properties": properties})
        for number, (stamp, row) in enumerate(zip(stamps, walk.rows[:, [place for place, _ in chosen]].tolist())):
            data = {one["name"]: None if value != value else value for (_, one), value in zip(chosen, row)}
            writer.add_message(channel, stamp, json.dumps(data).encode(), stamp, number)
    channel = _channel(writer, "/afo/events", {"type": "object", "properties": {"kind": {"type": "string"}}})
    for number, event in enumerate(walk.events):
        stamp = stamps[min(event["tick"], len(stamps) - 1)]
        writer.add_message(channel, stamp, json.dumps(event, default=str).encode(), stamp, number)
    writer.finish()
    return sink.getvalue()


def _channel(writer, topic, schema):
    number = writer.register_schema(topic.strip("/").replace("/", "."), "jsonschema", json.dumps(schema).encode())
    return writer.register_channel(topic, "json", number)


def main(arguments):
    parser = argparse.ArgumentParser(prog="afo report --export", description=__doc__)
    parser.add_argument("trial", type=pathlib.Path)
    parser.add_argument("--afo", required=True)
    parser.add_argument("--subject")
    parser.add_argument("--kind", choices=sorted(NEEDS), required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    options = parser.parse_args(arguments)
    for module, package in NEEDS[options.kind]:
        try:
            __import__(module)
        except ImportError as error:
            print(f"{options.kind} needs the Python package {module} ({error}): scripts/setup view, or "
                  f"python3 -m pip install {package}", file=sys.stderr)
            return EXIT_USAGE
    import frames
    import report
    import trial
    import walkdata
    try:
        walk = walkdata.load(options.trial, options.afo, options.subject)
        made = {"csv": to_csv, "json": to_json, "parquet": to_parquet, "mcap": to_mcap}[options.kind](walk)
        if options.kind == "csv" and str(options.out) != "-":
            report.write(to_json(walk), options.out.with_name(options.out.name + ".json"))
        report.write(made, options.out)
    except (OSError, trial.TrialError, frames.BadLine) as error:
        print(f"afo report --export: {error}", file=sys.stderr)
        return EXIT_USAGE
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
