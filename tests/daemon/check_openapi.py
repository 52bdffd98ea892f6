#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Holds real answers and stream messages of the daemon against the OpenAPI document that it serves; and checks that spoilt answers are
refused, so that the schemas are not ones that take all.

Usage: check_openapi.py ANSWERS.json    (written by openapi_test)
"""
import copy
import json
import re
import sys

import jsonschema


def references(node):
    if isinstance(node, dict):
        for key, value in node.items():
            if key == "$ref":
                yield value
            else:
                yield from references(value)
    elif isinstance(node, list):
        for value in node:
            yield from references(value)


def document_faults(document):
    if document["openapi"] != "3.1.0":
        yield f"openapi is {document['openapi']}"
    schemas = document["components"]["schemas"]
    for reference in references(document):
        name = reference.removeprefix("#/components/schemas/")
        if name not in schemas:
            yield f"{reference} does not exist"
    for name, schema in schemas.items():
        try:
            jsonschema.Draft202012Validator.check_schema(schema)
        except jsonschema.SchemaError as error:
            yield f"schema {name}: {error.message}"
    for path, item in document["paths"].items():
        operation = item["get"]
        named = {p["name"] for p in operation.get("parameters", []) if p["in"] == "path"}
        if set(re.findall(r"{(\w+)}", path)) != named:
            yield f"{path}: the parameters of the path are {named}"
        for parameter in operation.get("parameters", []):
            jsonschema.Draft202012Validator.check_schema(parameter["schema"])
        if not operation["summary"] or "default" not in operation["responses"]:
            yield f"{path}: no summary, or no default response"


def validator(document, schema):
    """For a schema within the document: its references are to the document's components."""
    return jsonschema.Draft202012Validator({**schema, "components": document["components"]})


def schema_of(document, answer):
    responses = document["paths"][answer["path"]]["get"]["responses"]
    response = responses.get(str(answer["status"]), responses["default"])
    return response["content"]["application/json"]["schema"]


def spoilt(body):
    """The answer without one of its keys, or with a key too many."""
    for key in body:
        other = copy.deepcopy(body)
        del other[key]
        yield key, other
    yield "colour", {**body, "colour": "red"}


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        recorded = json.load(file)
    document, faults = recorded["openapi"], []
    faults += document_faults(document)
    answered, optional = set(), {"hand", "wearers", "doorways", "unresolved", "run", "note", "covariance", "journal", "sigma", "visits", "plane", "corners", "size",
                                 "height_assumed", "ends", "inferred_sides"}
    for answer in recorded["answers"]:
        where = f"{answer['path']} {answer['question']} ({answer['status']})"
        check = validator(document, schema_of(document, answer))
        faults += [f"{where}: {error.json_path}: {error.message}" for error in check.iter_errors(answer["body"])]
        if answer["path"].endswith("openapi.json"):
            answered.add(answer["path"])
            continue
        faults += [f"{where}: a wrong {key} is taken" for key, body in spoilt(answer["body"]) if key not in optional and check.is_valid(body)]
        if answer["status"] in (200, 426):
            answered.add(answer["path"])
    described = {path for path, item in document["paths"].items()
                 if any("application/json" in response.get("content", {}) for status, response in item["get"]["responses"].items() if status in ("200", "426"))}
    faults += [f"{path}: no good answer was recorded" for path in described - answered]

    check = validator(document, {"$ref": "#/components/schemas/stream_message"})
    for message in recorded["messages"]:
        where = f"message {message['op']} {message.get('topic', '')}"
        faults += [f"{where}: {error.json_path}: {error.message}" for error in check.iter_errors(message)]
        faults += [f"{where}: a wrong {key} is taken" for key, other in spoilt(message) if key != "id" and check.is_valid(other)]
    for fault in faults:
        print(fault[:300])
    print(f"{len(recorded['answers'])} answers of {len(answered)} paths, {len(recorded['messages'])} messages, {len(faults)} faults")
    return 1 if faults else 0


sys.exit(main())
