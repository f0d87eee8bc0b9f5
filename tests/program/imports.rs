//! Finds out which file of the crate uses which, for the tests of architecture. It reads modules, `use` trees and paths
//! in code, and follows a re-export to the file that defines the name. Items under `#[cfg(test)]` do not count, because
//! a unit test may call a witness from any room.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};
use syn::{Attribute, Item, ItemUse, UseTree, Visibility};

/// A module as its path from the crate's root: `["mechanics", "chain"]`.
pub type Module = Vec<String>;

/// A name that a module imports: its own name for it, and the path it stands for.
struct Import {
    name: String,
    path: Vec<String>,
    reexported: bool,
}

/// One file of the crate.
struct File {
    path: PathBuf,
    defines: BTreeSet<String>,
    children: BTreeSet<String>,
    imports: Vec<Import>,
    /// Paths of two or more segments in the code itself.
    paths: Vec<Vec<String>>,
}

/// All files of the crate by module.
pub struct Crate {
    files: BTreeMap<Module, File>,
}

impl Crate {
    /// Reads the crate whose root is `src/lib.rs` in a folder.
    pub fn read(source: &Path) -> Self {
        let mut files = BTreeMap::new();
        read_module(Module::new(), &source.join("lib.rs"), source, &mut files);
        Self { files }
    }

    /// The source file of a module.
    pub fn path(&self, module: &Module) -> &Path {
        &self.files[module].path
    }

    /// All modules.
    pub fn modules(&self) -> impl Iterator<Item = &Module> {
        self.files.keys()
    }

    /// What a module re-exports: the name it has there, and the module and name of its definition. A glob is `*`.
    pub fn reexported(&self, module: &Module) -> Vec<(String, Module, String)> {
        let imports = self.files[module].imports.iter().filter(|import| import.reexported);
        let found = imports.filter_map(|import| {
            let path = self.absolute(module, &import.path)?;
            let (defining, name) = self.definition(&path, 0)?;
            Some((import.name.clone(), defining, name))
        });
        found.collect()
    }

    /// The modules that each module uses, with the names it takes from them.
    pub fn uses(&self) -> BTreeMap<Module, BTreeMap<Module, BTreeSet<String>>> {
        let mut out: BTreeMap<Module, BTreeMap<Module, BTreeSet<String>>> = BTreeMap::new();
        for (module, file) in &self.files {
            let imported = file.imports.iter().filter(|import| !import.reexported).map(|i| i.path.clone());
            let named = file.paths.iter().filter_map(|path| self.written_out(module, file, path));
            for path in imported.chain(named) {
                let Some((target, name)) = self.absolute(module, &path).and_then(|p| self.definition(&p, 0))
                else {
                    continue;
                };
                if target != *module {
                    out.entry(module.clone()).or_default().entry(target).or_default().insert(name);
                }
            }
        }
        out
    }

    /// A path in code with its first name replaced by what the file imports under that name.
    fn written_out(&self, module: &Module, file: &File, path: &[String]) -> Option<Vec<String>> {
        let first = path.first()?;
        if matches!(first.as_str(), "crate" | "self" | "super") || file.children.contains(first) {
            return Some(path.to_vec());
        }
        let import = file.imports.iter().find(|import| import.name == *first)?;
        let target = self.absolute(module, &import.path)?;
        // only a module leads on to other files
        self.files.contains_key(&target).then(|| [&import.path[..], &path[1..]].concat())
    }

    /// A path from the crate's root; `None` if it leads to another crate.
    fn absolute(&self, module: &Module, path: &[String]) -> Option<Vec<String>> {
        let mut base = match path.first()?.as_str() {
            "crate" => return Some(path[1..].to_vec()),
            "self" | "super" => module.clone(),
            first if self.files[module].children.contains(first) => {
                return Some([&module[..], path].concat());
            }
            _ => return None,
        };
        let mut rest = path;
        while let Some(first) = rest.first() {
            match first.as_str() {
                "self" => {}
                "super" => drop(base.pop()),
                _ => break,
            }
            rest = &rest[1..];
        }
        base.extend_from_slice(rest);
        Some(base)
    }

    /// The module that defines what a path names, re-exports followed, and the name.
    fn definition(&self, path: &[String], depth: usize) -> Option<(Module, String)> {
        let inside = (0..=path.len()).rev().find(|&n| self.files.contains_key(&path[..n]))?;
        let (module, rest) = path.split_at(inside);
        let Some(name) = rest.first().filter(|name| *name != "*") else {
            return Some((module.to_vec(), "(module)".into()));
        };
        let file = &self.files[module];
        let found = (module.to_vec(), name.clone());
        if file.defines.contains(name) || depth > 8 {
            return Some(found);
        }
        let through = file.imports.iter().find(|i| i.name == *name).map(|i| i.path.clone());
        let globbed = || {
            let globs = file.imports.iter().filter(|i| i.name == "*");
            let paths = globs.filter_map(|i| self.absolute(&module.to_vec(), &i.path));
            let mut modules = paths.map(|p| p[..p.len() - 1].to_vec());
            modules.find(|m| self.files.get(m).is_some_and(|f| f.defines.contains(name)))
        };
        match through.and_then(|path| self.absolute(&module.to_vec(), &path)) {
            Some(path) => self.definition(&path, depth + 1),
            None => Some(globbed().map_or(found, |module| (module, name.clone()))),
        }
    }
}

fn read_module(module: Module, path: &Path, folder: &Path, files: &mut BTreeMap<Module, File>) {
    let text = fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let syntax = syn::parse_file(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut reader = Reader::default();
    reader.visit_file(&syntax);
    for child in &reader.children {
        let inside = folder.join(child);
        let single = folder.join(format!("{child}.rs"));
        let path = if single.is_file() { single } else { inside.join("mod.rs") };
        read_module([&module[..], std::slice::from_ref(child)].concat(), &path, &inside, files);
    }
    let Reader { defines, children, imports, paths } = reader;
    files.insert(module, File { path: path.to_path_buf(), defines, children, imports, paths });
}

/// Collects what a file defines and uses.
#[derive(Default)]
struct Reader {
    defines: BTreeSet<String>,
    children: BTreeSet<String>,
    imports: Vec<Import>,
    paths: Vec<Vec<String>>,
}

impl Reader {
    fn import(&mut self, tree: &UseTree, before: &[String], reexported: bool) {
        let with = |name: &str| [before, &[name.to_string()]].concat();
        match tree {
            UseTree::Path(path) => self.import(&path.tree, &with(&path.ident.to_string()), reexported),
            UseTree::Group(group) => {
                group.items.iter().for_each(|tree| self.import(tree, before, reexported));
            }
            UseTree::Name(name) if name.ident == "self" => {
                let name = before.last().cloned().unwrap_or_default();
                self.imports.push(Import { name, path: before.to_vec(), reexported });
            }
            UseTree::Name(name) => {
                let name = name.ident.to_string();
                self.imports.push(Import { path: with(&name), name, reexported });
            }
            UseTree::Rename(rename) => {
                let path = with(&rename.ident.to_string());
                self.imports.push(Import { name: rename.rename.to_string(), path, reexported });
            }
            UseTree::Glob(_) => self.imports.push(Import { name: "*".into(), path: with("*"), reexported }),
        }
    }
}

impl<'ast> Visit<'ast> for Reader {
    fn visit_item(&mut self, item: &'ast Item) {
        if attributes(item).iter().any(is_test) {
            return;
        }
        let name = match item {
            Item::Fn(item) => Some(&item.sig.ident),
            Item::Struct(item) => Some(&item.ident),
            Item::Enum(item) => Some(&item.ident),
            Item::Trait(item) => Some(&item.ident),
            Item::Type(item) => Some(&item.ident),
            Item::Const(item) => Some(&item.ident),
            Item::Static(item) => Some(&item.ident),
            Item::Macro(item) => item.ident.as_ref(),
            Item::Mod(item) if item.content.is_none() => {
                self.children.insert(item.ident.to_string());
                None
            }
            _ => None,
        };
        self.defines.extend(name.map(ToString::to_string));
        visit::visit_item(self, item);
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        let reexported = !matches!(item.vis, Visibility::Inherited);
        self.import(&item.tree, &[], reexported);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.segments.len() > 1 {
            self.paths.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, mac: &'ast syn::Macro) {
        // the arguments of most macros are expressions
        let list = syn::punctuated::Punctuated::<syn::Expr, syn::Token![,]>::parse_terminated;
        if let Ok(arguments) = mac.parse_body_with(list) {
            for argument in &arguments {
                let mut inner = Reader::default();
                inner.visit_expr(argument);
                self.paths.extend(inner.paths);
            }
        }
        visit::visit_macro(self, mac);
    }
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Fn(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Const(item) => &item.attrs,
        _ => &[],
    }
}

fn is_test(attribute: &Attribute) -> bool {
    attribute.path().is_ident("cfg")
        && attribute.parse_args::<syn::Path>().is_ok_and(|path| path.is_ident("test"))
}

/// Sets of more than one node that reach each other (strongly connected components).
pub fn circles(edges: &BTreeMap<Module, BTreeMap<Module, BTreeSet<String>>>) -> Vec<Vec<Module>> {
    let reach: BTreeMap<&Module, BTreeSet<&Module>> =
        edges.keys().map(|from| (from, reached(from, edges))).collect();
    let mut out: Vec<Vec<Module>> = Vec::new();
    for from in edges.keys() {
        let back = |to: &&&Module| reach.get(**to).is_some_and(|r| r.contains(from));
        let mut circle: Vec<Module> = reach[from].iter().filter(back).map(|m| (*m).clone()).collect();
        circle.sort();
        if circle.len() > 1 && !out.contains(&circle) {
            out.push(circle);
        }
    }
    out
}

/// Every module that a module uses, by whatever way.
fn reached<'e>(
    from: &Module,
    edges: &'e BTreeMap<Module, BTreeMap<Module, BTreeSet<String>>>,
) -> BTreeSet<&'e Module> {
    let mut out = BTreeSet::new();
    let mut open: Vec<&Module> = edges.get(from).into_iter().flat_map(BTreeMap::keys).collect();
    while let Some(next) = open.pop() {
        if out.insert(next) {
            open.extend(edges.get(next).into_iter().flat_map(BTreeMap::keys));
        }
    }
    out
}
