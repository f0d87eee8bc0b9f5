//! The JSON Schema of effects, made from the kinds of effects that the library has.

use crate::arm::BASE;
use crate::arm::effect::catalogue::KINDS;
use crate::arm::effect::kind::{Kind as EffectKind, Parameter, Place};
use serde_json::{Map, Value, json};

/// Name of the schema of effects on the command line, and its description.
pub(super) const EFFECTS: (&str, &str) =
    ("effects", "An effect as arm files, studies and verdicts have it: places, parameters and their bounds.");

/// The JSON Schema of an entry of `effects`: for each effect, its places and parameters.
pub(super) fn effects_schema() -> Value {
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Armwright: effects",
        "description": EFFECTS.1,
        "oneOf": KINDS.iter().flat_map(|kind| of_effect(kind)).collect::<Vec<_>>(),
    })
}

/// The schemas of an effect: one for each set of parameters. The effect has the same parameters at all places of one
/// schema.
fn of_effect(kind: &EffectKind) -> Vec<Value> {
    let mut groups: Vec<(Vec<Place>, &[Parameter])> = Vec::new();
    for &place in kind.places {
        let parameters = (kind.parameters)(place);
        match groups.iter_mut().find(|(_, of)| *of == parameters) {
            Some((places, _)) => places.push(place),
            None => groups.push((vec![place], parameters)),
        }
    }
    let one = |(places, parameters): (Vec<Place>, &[Parameter])| {
        let needed: Vec<&str> = parameters.iter().filter(|p| p.default.is_none()).map(|p| p.name).collect();
        let properties: Map<String, Value> =
            parameters.iter().map(|p| (p.name.to_string(), of_parameter(p))).collect();
        let words: Vec<String> = places.iter().map(|place| place_words(*place)).collect();
        json!({
            "description": kind.summary,
            "type": "object",
            "required": ["effect", "at", "parameters"],
            "properties": {
                "effect": {"const": kind.name},
                "at": {"type": "string", "description": words.join("; ")},
                "parameters": {
                    "type": "object",
                    "properties": properties,
                    "required": needed,
                    "additionalProperties": false,
                },
            },
        })
    };
    groups.into_iter().map(one).collect()
}

fn place_words(place: Place) -> String {
    match place {
        Place::Joint => "a joint that turns".into(),
        Place::Prismatic => "a prismatic joint".into(),
        Place::Link => "a link".into(),
        Place::Tube => "a link that is a tube".into(),
        Place::Base => BASE.into(),
        Place::Payload => "payload".into(),
        Place::Arm => "arm".into(),
        Place::Channel(channel) => channel.word().into(),
    }
}

fn of_parameter(parameter: &Parameter) -> Value {
    if parameter.is_channel {
        return json!({"type": "string", "description": "a channel: static, modal, windup or positions"});
    }
    let mut number = json!({"type": "number"});
    let (low, high) = parameter.readable();
    for (key, bound) in [("minimum", low), ("maximum", high)] {
        // an infinite bound is left out
        if bound.is_finite() {
            number[key] = json!(bound);
        }
    }
    if let Some(default) = parameter.default {
        number["default"] = json!(default);
    }
    match parameter.count {
        0 => json!({"type": "array", "items": number}),
        1 => number,
        count => json!({"type": "array", "items": number, "minItems": count, "maxItems": count}),
    }
}
