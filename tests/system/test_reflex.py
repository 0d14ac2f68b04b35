"""A person who walks by reflexes, in closed loop with the device over the in-process bus."""
import json

from afo import run

WORN = ("--plant", "reflex", "--person", "sim_host/persons/adult70.ini", "--device", "sim_host/devices/virtual-adult.ini")


def test_the_device_finds_the_steps_of_a_reflex_person(tmp_path):
    """Their legs are late and early as muscles make them, and nobody recorded them."""
    walked = run(*WORN, "--steps", "12", "--json", "--quiet", "--log", tmp_path / "one.log")
    assert walked.returncode == 0, walked.stderr
    told = json.loads(walked.stdout)
    assert told["steps"] == 12 and not told["fell"] and told["fault"] is None
    assert told["apexes_left"] >= 5 and told["apexes_right"] >= 5
    again = run(*WORN, "--steps", "12", "--json", "--quiet", "--log", tmp_path / "two.log")
    assert again.returncode == 0
    assert (tmp_path / "one.log").read_bytes() == (tmp_path / "two.log").read_bytes()


def test_the_papers_walker_is_no_person():
    refused = run("--plant", "reflex", "--steps", "3")
    assert refused.returncode == 2
    assert "name a person of 10 kg or more with --person" in refused.stderr


def test_there_is_one_wearer():
    refused = run("--plant", "reflex", "--recording", "x.csv")
    assert refused.returncode == 2 and "there is one wearer" in refused.stderr
    refused = run("--plant", "compass")
    assert refused.returncode == 2 and "walker, reflex" in refused.stderr.replace(" or", ",")
