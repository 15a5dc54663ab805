#!/usr/bin/env python3
"""What it costs to know nothing: estimates of sessions without a hint beside estimates that start at the
truth, in turns, medians of the times that result.json states. One row per session.

  bench/start_time.py --program build/release/turnlight SESSION...

Each SESSION has a truth.json. Usage: bench/start_time.py [--program FILE] [--rounds N] SESSION...
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile


def times(program, session, options, out):
    command = [program, "estimate", session, "--out", out, "--no-pictures", "--json"] + options
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit code {done.returncode}\n{done.stderr}")
    return json.loads(done.stdout)["time_s"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--program", default="build/release/turnlight")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("sessions", nargs="+", metavar="SESSION")
    arguments = parser.parse_args()
    print("| session | no hint: initial, solve (s) | from the truth: initial, solve (s) "
          "| initial + solve, ratio | whole command, ratio |")
    print("|---|---|---|---|---|")
    for session in arguments.sessions:
        truth = ["--initial", os.path.join(session, "truth.json")]
        runs = {"free": [], "truth": []}
        with tempfile.TemporaryDirectory() as out:
            for _ in range(arguments.rounds):
                runs["free"].append(times(arguments.program, session, [], out))
                runs["truth"].append(times(arguments.program, session, truth, out))

        def median(kind, *keys):
            return statistics.median(sum(run[key] for key in keys) for run in runs[kind])

        def shown(kind):
            return f"{median(kind, 'initial'):.2f}, {median(kind, 'solve'):.2f}"

        def ratio(*keys):
            return f"{median('free', *keys) / median('truth', *keys):.2f}"

        print(f"| {os.path.basename(os.path.normpath(session))} | {shown('free')} "
              f"| {shown('truth')} | {ratio('initial', 'solve')} | {ratio('total')} |")


if __name__ == "__main__":
    main()
