//! Compares the public interface of the library with `tests/data/public-api.txt`, so that a change of the interface
//! shows in the diff of that file.
//!
//! The lint `unreachable_pub` is denied, so an item that is written `pub` can be reached by other programs. The file
//! lists each such item with its path and its signature. The command line (`command_line`) is not part of it. To write
//! the file again:
//!
//! ```text
//! ARMWRIGHT_REFRESH=1 cargo test --test program public_interface
//! ```

use crate::imports::{Crate, Module};
use quote::ToTokens;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use syn::{Attribute, Fields, ImplItem, Item, TraitItem, Visibility};

#[test]
fn the_public_interface_is_the_one_that_is_written_down() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = root.join("tests/data/public-api.txt");
    let now = interface(&Crate::read(&root.join("src")));
    assert!(now.len() > 300, "the interface is not where this test looks: {} items", now.len());
    if std::env::var_os("ARMWRIGHT_REFRESH").is_some() {
        fs::write(&file, now.join("\n") + "\n").expect("written");
        return;
    }
    let text = fs::read_to_string(&file).expect("tests/data/public-api.txt");
    let was: BTreeSet<&str> = text.lines().collect();
    let now: BTreeSet<&str> = now.iter().map(String::as_str).collect();
    let lines = |sign: &str, lines: Vec<&&str>| -> String {
        lines.iter().map(|line| format!("{sign} {line}\n")).collect()
    };
    let gone = lines("-", was.difference(&now).collect());
    let new = lines("+", now.difference(&was).collect());
    assert!(
        gone.is_empty() && new.is_empty(),
        "the public interface changed:\n{gone}{new}if that is meant, say so in CHANGELOG.md and write the file anew:\n\
         ARMWRIGHT_REFRESH=1 cargo test --test program public_interface"
    );
}

#[test]
fn an_item_is_listed_by_the_path_by_which_it_is_reached() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("written");
    write("lib.rs", "pub mod a;\nmod b;\n");
    write("a.rs", "pub use crate::b::Two;\npub struct One { pub x_m: f64, y: u8 }\npub(crate) fn f() {}\n");
    write(
        "b.rs",
        "pub enum Two { A, B(u8) }\nimpl Two { pub fn of(x: &str) -> Self { Two::A } fn g() {} }\n\
         pub(crate) trait Own {}\nimpl Own for Two {}\n",
    );
    let expected = [
        "a::One struct",
        "a::One.x_m: f64",
        "a::Two enum",
        "a::Two.of fn of(x: &str) -> Self",
        "a::Two::A",
        "a::Two::B(u8)",
    ];
    assert_eq!(interface(&Crate::read(folder.path())), expected);
}

/// Every public item but those of the command line, a line each, sorted.
fn interface(house: &Crate) -> Vec<String> {
    let files: BTreeMap<Module, syn::File> = house
        .modules()
        .filter(|module| module.first().is_none_or(|room| room != "cli"))
        .map(parsed(house))
        .collect();
    let reached = reached(house, &files);
    let public_names: BTreeSet<&String> = reached.keys().map(|(_, name)| name).collect();
    let private_traits = files.values().flat_map(|file| file.items.iter().filter_map(private_trait));
    let private_traits: BTreeSet<String> = private_traits.collect();
    let is_public = |item: &&Item| match item {
        Item::Impl(syn::ItemImpl { trait_: Some((_, of_trait, _)), .. }) => {
            !of_trait.segments.last().is_some_and(|name| private_traits.contains(&name.ident.to_string()))
        }
        _ => true,
    };
    let mut out = BTreeSet::new();
    for (module, file) in &files {
        for item in file.items.iter().filter(|item| !is_of_tests(item)).filter(is_public) {
            let at = |name: &str| {
                let own = (module.clone(), name.to_string());
                reached.get(&own).cloned().unwrap_or_else(|| format!("({}::{name})", module.join("::")))
            };
            let defined = |name: &str| {
                // methods may stand in another file than their type
                let elsewhere =
                    reached.iter().find(|((_, other), _)| other == name).map(|(_, path)| path.clone());
                let own = reached.get(&(module.clone(), name.to_string())).cloned();
                own.or(elsewhere).unwrap_or_else(|| at(name))
            };
            out.extend(lines(item, &at, &defined, &public_names));
        }
    }
    out.into_iter().collect()
}

fn parsed(house: &Crate) -> impl Fn(&Module) -> (Module, syn::File) {
    |module| {
        let text = fs::read_to_string(house.path(module)).expect("a source file");
        (module.clone(), syn::parse_file(&text).expect("a source file that parses"))
    }
}

/// The path by which each public item is reached from outside, by the module that defines it and its name. An item without an
/// entry has no path: only values of it are handed out.
fn reached(house: &Crate, files: &BTreeMap<Module, syn::File>) -> BTreeMap<(Module, String), String> {
    let mut out: BTreeMap<(Module, String), String> = BTreeMap::new();
    for (module, file) in files.iter().filter(|(module, _)| is_public(module, files)) {
        let path = |name: &str| [&module[..], &[name.to_string()]].concat().join("::");
        for name in file.items.iter().filter_map(public_name) {
            out.insert((module.clone(), name.clone()), path(&name));
        }
        for (name, defining, defined) in house.reexported(module) {
            let own = files.get(&defining).into_iter().flat_map(|f| f.items.iter().filter_map(public_name));
            let names: Vec<(String, String)> = match name.as_str() {
                "*" => own.map(|name| (name.clone(), name)).collect(),
                _ => vec![(name, defined)],
            };
            for (name, defined) in names {
                out.entry((defining.clone(), defined)).or_insert(path(&name));
            }
        }
    }
    out
}

/// Whether a module and all those that it is in are public.
fn is_public(module: &Module, files: &BTreeMap<Module, syn::File>) -> bool {
    (1..=module.len()).all(|depth| {
        let items = files.get(&module[..depth - 1]).map_or(&[][..], |file| &file.items);
        items.iter().any(|item| match item {
            Item::Mod(inner) => {
                inner.ident == module[depth - 1] && matches!(inner.vis, Visibility::Public(_))
            }
            _ => false,
        })
    })
}

/// The name of a public item that is no module and no re-export.
fn public_name(item: &Item) -> Option<String> {
    let (vis, ident) = match item {
        Item::Fn(item) => (&item.vis, &item.sig.ident),
        Item::Struct(item) => (&item.vis, &item.ident),
        Item::Enum(item) => (&item.vis, &item.ident),
        Item::Trait(item) => (&item.vis, &item.ident),
        Item::Type(item) => (&item.vis, &item.ident),
        Item::Const(item) => (&item.vis, &item.ident),
        Item::Static(item) => (&item.vis, &item.ident),
        _ => return None,
    };
    matches!(vis, Visibility::Public(_)).then(|| ident.to_string())
}

/// The name of a trait that is not public; `None` for all other items.
fn private_trait(item: &Item) -> Option<String> {
    match item {
        Item::Trait(item) if !matches!(item.vis, Visibility::Public(_)) => Some(item.ident.to_string()),
        _ => None,
    }
}

/// The lines of an item: itself, its public fields, its variants, its methods, the traits that it has.
fn lines(
    item: &Item,
    at: &dyn Fn(&str) -> String,
    defined: &dyn Fn(&str) -> String,
    public_names: &BTreeSet<&String>,
) -> Vec<String> {
    if let Item::Impl(block) = item {
        return methods(block, defined, public_names);
    }
    let Some(name) = public_name(item) else { return Vec::new() };
    let path = at(&name);
    match item {
        Item::Fn(item) => vec![format!("{path} {}", words(&item.sig))],
        Item::Struct(item) => fields(&path, "struct", &item.generics, &item.fields),
        Item::Enum(item) => {
            let variant = |v: &syn::Variant| {
                let mut plain = v.clone();
                plain.attrs.clear();
                plain.fields.iter_mut().for_each(|field| field.attrs.clear());
                format!("{path}::{}", words(&plain))
            };
            let own = format!("{path} enum{}", words(&item.generics));
            std::iter::once(own).chain(item.variants.iter().map(variant)).collect()
        }
        Item::Trait(item) => {
            let of_trait = item.items.iter().filter_map(|inner| match inner {
                TraitItem::Fn(inner) => Some(format!("{path}.{} {}", inner.sig.ident, words(&inner.sig))),
                TraitItem::Type(inner) => Some(format!("{path}::{} type", inner.ident)),
                TraitItem::Const(inner) => {
                    Some(format!("{path}::{} const: {}", inner.ident, words(&inner.ty)))
                }
                _ => None,
            });
            std::iter::once(format!("{path} trait{}", words(&item.generics))).chain(of_trait).collect()
        }
        Item::Type(item) => vec![format!("{path} type = {}", words(&item.ty))],
        Item::Const(item) => vec![format!("{path} const: {}", words(&item.ty))],
        Item::Static(item) => vec![format!("{path} static: {}", words(&item.ty))],
        _ => Vec::new(),
    }
}

fn fields(path: &str, what: &str, generics: &syn::Generics, fields: &Fields) -> Vec<String> {
    let mut out = vec![format!("{path} {what}{}", words(generics))];
    for (index, field) in fields.iter().enumerate().filter(|(_, f)| matches!(f.vis, Visibility::Public(_))) {
        let name = field.ident.as_ref().map_or(index.to_string(), ToString::to_string);
        out.push(format!("{path}.{name}: {}", words(&field.ty)));
    }
    out
}

/// The public methods of a block without a trait; a block with a trait is one line.
fn methods(
    block: &syn::ItemImpl,
    defined: &dyn Fn(&str) -> String,
    public_names: &BTreeSet<&String>,
) -> Vec<String> {
    let syn::Type::Path(of) = &*block.self_ty else { return Vec::new() };
    let name = of.path.segments.last().expect("a name").ident.to_string();
    if !public_names.contains(&name) {
        return Vec::new();
    }
    let path = defined(&name);
    if let Some((_, of_trait, _)) = &block.trait_ {
        return vec![format!("{path} impl {}", words(of_trait))];
    }
    let method = |item: &ImplItem| match item {
        ImplItem::Fn(item) if matches!(item.vis, Visibility::Public(_)) => {
            Some(format!("{path}.{} {}", item.sig.ident, words(&item.sig)))
        }
        ImplItem::Const(item) if matches!(item.vis, Visibility::Public(_)) => {
            Some(format!("{path}::{} const: {}", item.ident, words(&item.ty)))
        }
        _ => None,
    };
    block.items.iter().filter_map(method).collect()
}

/// Source text with the spaces that people write.
fn words(tokens: &impl ToTokens) -> String {
    let mut text = tokens.to_token_stream().to_string();
    let spaces = [
        (" :: ", "::"),
        (":: ", "::"),
        (" <", "<"),
        ("< ", "<"),
        (" >", ">"),
        ("- >", "->"),
        ("& ", "&"),
        (" ,", ","),
        (",)", ")"),
        (" :", ":"),
        ("( ", "("),
        (" (", "("),
        (" )", ")"),
        ("[ ", "["),
        (" ]", "]"),
        (" ;", ";"),
        ("' ", "'"),
    ];
    for (printed, written) in spaces {
        text = text.replace(printed, written);
    }
    text.replace("->", " -> ").replace("  ", " ").replace(",)", ")").replace(", )", ")")
}

fn is_of_tests(item: &Item) -> bool {
    let attributes: &[Attribute] = match item {
        Item::Fn(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Const(item) => &item.attrs,
        _ => &[],
    };
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute.parse_args::<syn::Path>().is_ok_and(|path| path.is_ident("test"))
    })
}
