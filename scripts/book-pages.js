// A preprocessor of mdBook (https://rust-lang.github.io/mdBook/for_developers/preprocessors.html). It turns the equations of
// the pages into HTML with KaTeX, and links out of docs/ into plain text, because the book stands alone.
"use strict";

const fs = require("fs");
const path = require("path");
const katex = require(path.resolve("target/tools/katex/node_modules/katex"));

if (process.argv[2] === "supports") process.exit(process.argv[3] === "html" ? 0 : 1);

const [context, book] = JSON.parse(fs.readFileSync(0, "utf8"));
const source = path.join(context.root, context.config.book.src);
const items = book.items || book.sections;
const chapters = new Set();
walk(items, (chapter) => chapters.add(chapter.path));
walk(items, (chapter) => { chapter.content = page(chapter.content, chapter.path); });
process.stdout.write(JSON.stringify(book));

function walk(list, visit) {
  for (const item of list) {
    if (!item.Chapter) continue;
    if (item.Chapter.path) visit(item.Chapter);
    walk(item.Chapter.sub_items, visit);
  }
}

// Code stays as it is, fences and spans: a mark takes its place while the rest changes.
function page(text, place) {
  const code = [];
  const marked = text.replace(/^```[\s\S]*?^```[^\n]*$|`[^`\n]*`/gm, (piece) => `\u0001${code.push(piece) - 1}\u0001`);
  const changed = links(equations(marked, place), place);
  return changed.replace(/\u0001(\d+)\u0001/g, (_, i) => code[i]);
}

function equations(text, place) {
  return text
    .replace(/\$\$([\s\S]+?)\$\$/g, (_, tex) => `\n\n<div>${html(tex, true, place)}</div>\n\n`)
    .replace(/\$([^$\n]+?)\$/g, (_, tex) => html(tex, false, place));
}

// An equation that KaTeX cannot read stops the build.
function html(tex, displayMode, place) {
  try {
    const out = katex.renderToString(tex.trim(), { displayMode, throwOnError: true, strict: "ignore" });
    // Markdown reads what is between tags
    return out.replace(/[\\_*|`\n]/g, (c) => `&#${c.charCodeAt(0)};`);
  } catch (error) {
    throw new Error(`docs/${place}: ${error.message}`);
  }
}

function links(text, place) {
  return text.replace(/(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s]+)\)/g, (whole, image, words, target) => {
    if (target.startsWith("#") || target.includes("://")) return whole;
    const [file, anchor] = target.split("#");
    const inside = path.normalize(path.join(path.dirname(place), file));
    for (const name of [inside, path.join(inside, "README.md")]) {
      const is_picture = image && fs.existsSync(path.join(source, name));
      if (chapters.has(name) || is_picture) {
        const relative = path.relative(path.dirname(place), name);
        return `${image}[${words}](${relative}${anchor ? "#" + anchor : ""})`;
      }
    }
    return image ? "" : words;
  });
}
