#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Checks map JSON files against map.schema.json; and that spoilt maps are refused, so that the schema is not one that takes all.

Usage: check_schema.py SCHEMA MAP.json…    (the first map must hold a wall, a table, a screen and a chair)
"""
import copy
import json
import sys

import jsonschema


def spoilt(whole):
    """Maps that differ from a valid one in a single place, each of which the schema must refuse."""
    def change(where, value):
        other = copy.deepcopy(whole)
        place = other
        for key in where[:-1]:
            place = place[key]
        place[where[-1]] = value
        return where, other

    yield change(["version"], 2)
    yield change(["objects", 0, "type"], "sofa")
    yield change(["objects", 0, "pose", "position"], [1, 2])
    yield change(["objects", 0, "pose", "orientation"], [-1, 0, 0, 0])
    yield change(["objects", 0, "sigma"], {})
    yield change(["objects", 0, "size"], None)
    yield change(["objects", 1, "corners"], [[0, 0, 0]])
    yield change(["objects", 1, "height_assumed"], False)
    yield change(["objects", 0, "ends"], ["corner", "door"])
    yield change(["objects", 1, "colour"], "red")
    yield change(["rooms", 0, "polygon"], [[0, 0], [1, 1]])
    yield change(["graph", "contacts"], -1)
    yield change(["hand", "part"], "elbow")
    yield change(["wearers"], [{"name": "Anna", "hand": whole["hand"]}])
    yield change(["wearers"], [{"hand": whole["hand"]}, {"name": "Anna"}])
    for key in whole:
        if key in ("hand", "wearers", "doorways"):  # not always known
            continue
        other = copy.deepcopy(whole)
        del other[key]
        yield [key], other


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        schema = json.load(file)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    bad = 0
    maps = []
    for path in sys.argv[2:]:
        with open(path, encoding="utf-8") as file:
            maps.append(json.load(file))
        for error in validator.iter_errors(maps[-1]):
            print(f"{path}: {error.json_path}: {error.message}")
            bad += 1
    for where, other in spoilt(maps[0]):
        if validator.is_valid(other):
            print(f"the schema takes a map with a wrong {where}")
            bad += 1
    print(f"{len(maps)} maps, {bad} errors")
    return 1 if bad or not maps else 0


sys.exit(main())
