"""Runs the commands with a build and keeps what each gave.

A side (before, after) has a working folder, where links lead to the project's data, and a store of outputs:
STORE/<command>/<key>/{stdout,stderr,exit,out/}. The key is made of all that the outputs depend on, so that a store can be kept:
the binary, the arguments, the files they name, and the keys of the commands whose results they read.
"""

import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from pathlib import Path

from . import commands

LINKED = ["examples", "tests", "studies"]
# What runs now; what is stopped half-way is not kept.
RUNNING = set()
STOPPED = threading.Event()


class Side:
    """One build, its working folder and its store."""

    def __init__(self, root, binary, work, store):
        self.binary, self.work, self.store = binary, work, store
        self.digest = digest_file(binary)
        self.keys, self.ran, self.kept = {}, 0, 0
        self.lock = threading.Lock()
        (work / "out").mkdir(parents=True)
        for name in LINKED:
            (work / name).symlink_to(root / name)
        commands.write_made(root, work / "made")

    def folder(self, command):
        """Where a command's outputs are kept."""
        return self.store / command.name / self.keys[command.name]

    def key(self, command):
        """What the outputs depend on, as a name. Whatever this command needs has its key."""
        parts = [self.digest, *command.argv, *(self.keys[need] for need in command.needs)]
        for arg in command.argv:
            path = self.work / arg
            if "{" not in arg and arg.split("/")[0] in [*LINKED, "made"] and path.exists():
                # an arm file's neighbours count too: a campaign names its arms
                parts.append(digest_folder(path if path.is_dir() else path.parent))
        return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:16]

    def run(self, command):
        """Runs a command, unless its outputs are in the store; links its results to where others look for them."""
        self.keys[command.name] = self.key(command)
        kept, results = self.folder(command), self.work / "out" / command.name
        results.parent.mkdir(parents=True, exist_ok=True)
        fresh = not kept.is_dir()
        if fresh:
            self.run_into(command, kept, results)
        with self.lock:
            self.ran, self.kept = self.ran + fresh, self.kept + (not fresh)
        if (kept / "out").is_dir():
            results.symlink_to(kept / "out")

    def run_into(self, command, kept, results):
        """Runs a command and moves all that it gave into the store at once."""
        started = time.monotonic()
        process = subprocess.Popen(["armwright", *self.resolved(command)], executable=self.binary, cwd=self.work,
                                   env=environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        RUNNING.add(process)
        stdout, stderr = process.communicate()
        RUNNING.discard(process)
        if STOPPED.is_set():
            raise InterruptedError(command.name)
        took_s = time.monotonic() - started
        if took_s > 20:
            print(f"{command.name}: {took_s:.0f} s", file=sys.stderr)
        kept.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=kept.parent, prefix="new-") as new:
            new = Path(new) / "result"
            new.mkdir()
            (new / "stdout").write_bytes(stdout)
            (new / "stderr").write_bytes(stderr)
            (new / "exit").write_text(f"{process.returncode}\n")
            (new / "work").write_text(f"{self.work}\n")
            if results.exists():
                shutil.move(results, new / "out")
            try:
                new.rename(kept)
            except OSError:
                # somebody who shares the store was faster
                if not kept.is_dir():
                    raise

    def resolved(self, command):
        """The arguments, with folders and picked designs in their places."""

        def value(match):
            kind, name, pick = match.groups()
            if kind == "pick":
                return picked(self.work / "out" / name / "run.json", pick)
            return f"out/{name or command.name}"

        return [commands.PLACEHOLDER.sub(value, arg) for arg in command.argv]


def picked(run_json, pick):
    """design_id of a pick; a word that no design has for its name, if there is none."""
    try:
        picks = json.loads(run_json.read_text())["picks"]
        return next(p["design_id"] for p in picks if pick in p["names"])
    except (OSError, ValueError, KeyError, StopIteration):
        return "no-such-pick"


def environment():
    """Nothing of the caller's own that could change an output."""
    return {"PATH": os.environ.get("PATH", ""), "HOME": "/", "LANG": "C.UTF-8", "NO_COLOR": "1", "COLUMNS": "100"}


def digest_file(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def digest_folder(folder):
    """Of the names and contents of the data files in a folder."""
    total = hashlib.sha256()
    for path in sorted(p for p in folder.iterdir() if p.suffix in [".json", ".csv"]):
        total.update(f"{path.name}\0{digest_file(path)}\0".encode())
    return total.hexdigest()


@contextmanager
def sides(root, given):
    """A side for each name with a binary and a folder for its store, which may be None.

    Working folders are temporary, and so is a store without a folder of its own.
    """
    with ExitStack() as stack:
        made = {}
        for name, (binary, cache) in given.items():
            temporary = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="same-results-")))
            store = (cache or temporary / "store").resolve()
            store.mkdir(parents=True, exist_ok=True)
            made[name] = Side(root, Path(binary).resolve(), temporary / "work", store)
        yield made


def run_all(plan, both, jobs):
    """Runs the plan with every side, `jobs` commands at a time, each after those that it needs."""
    done = {}

    def task(side, command):
        # what is needed stands earlier in the plan and so was begun: waiting for it ends
        for need in command.needs:
            done[id(side), need].result()
        side.run(command)

    pool = ThreadPoolExecutor(max_workers=jobs)
    try:
        for command in plan:
            for side in both:
                done[id(side), command.name] = pool.submit(task, side, command)
        for future in done.values():
            future.result()
    finally:
        # after a fault or an interruption, the rest is not begun
        STOPPED.set()
        for process in list(RUNNING):
            process.terminate()
        pool.shutdown(cancel_futures=True)
