// Tests the page's pure functions: formats, filters, the state in the address, selection of curves, validation.

import assert from "node:assert/strict";
import test from "node:test";
import { gunzipSync } from "node:zlib";
import { count, counted, duration, engineering, errorDecades, quantity, significant } from "../../src/report/page/source/format.ts";
import { csv, latex, latexNumber, latexText, oneLine, plotText, sceneLabel, shorten, type Cell } from "../../src/report/page/source/text.ts";
import { parseFilter } from "../../src/report/page/source/filter.ts";
import { parseFragment, parseList, writeFragment, writeList } from "../../src/report/page/source/fragment.ts";
import { light, mostLit, toggleLit } from "../../src/report/page/source/lit.ts";
import { front, thinned } from "../../src/report/page/source/thin.ts";
import { dashes, markOf, marks, colorOf } from "../../src/report/page/source/marks.ts";
import { faultOf, limitOf, RowIndex, rowAt, settingText, type Row } from "../../src/report/page/source/rows.ts";
import { sortedPlaces } from "../../src/report/page/source/table_view.ts";
import { guidesOf, isAtFloor, isOff } from "../../src/report/page/source/sections/convergence.ts";
import { resultContent } from "../../src/report/page/source/sections/tables.ts";
import { exponentText } from "../../src/report/page/source/sections/drift.ts";
import { shadeOf, sharesOf, tickPlaces } from "../../src/report/page/source/sections/stability.ts";
import type { Curve } from "../../src/report/page/source/curve_plot.ts";
import type { Order } from "../../src/report/page/source/data.ts";
import { embed } from "./embed.ts";
import { emptyDocument, hostileNames, manyRows, nothingKnown, oneRow, richDocument } from "./sample.ts";

const thin = "\u202f";

test("significant digits", () => {
  const cases: [number, number, string][] = [
    [3.5941, 3, "3.59"], [0.00133, 3, "0.00133"], [1.59e-5, 3, "1.59e-5"], [0, 3, "0"], [-2.5, 3, "-2.5"], [100, 3, "100"], [999.9, 3, "1000"], [123456, 3, "123000"],
    [1234567, 3, "1.23e6"], [1e300, 3, "1e300"], [0.1 + 0.2, 4, "0.3"], [9.9996e-4, 4, "0.001"], [2 ** -53, 4, "1.11e-16"], [40000, 4, "40000"],
  ];
  for (const [value, digits, text] of cases) assert.equal(significant(value, digits), text);
  assert.equal(significant(null), "");
  assert.equal(significant(NaN), "");
  assert.equal(significant(-Infinity), "-inf");
  // parsing returns the value to the printed digits
  for (let i = -300; i < 300; i += 7) {
    const value = 1.2345678 * 10 ** i;
    assert.ok(Math.abs(Number(significant(value, 4)) / value - 1) < 5e-4, significant(value, 4));
  }
});

test("prefixes", () => {
  assert.equal(engineering(4.458e-7, "s"), `446${thin}ns`);
  assert.equal(engineering(0.001, "s"), `1${thin}ms`);
  assert.equal(engineering(9.9996e-4, "s"), `1${thin}ms`); // rounding carries into the next prefix
  assert.equal(engineering(1, "s"), `1${thin}s`);
  assert.equal(engineering(1500, "N"), `1.5${thin}kN`);
  assert.equal(engineering(-2.5e-6, "m"), `-2.5${thin}µm`);
  assert.equal(engineering(0, "s"), "0 s");
  assert.equal(engineering(null, "s"), "");
  assert.equal(duration(40000), `40000${thin}s`);
  assert.equal(count(1234567), `1${thin}234${thin}567`);
  assert.equal(count(-1234), `\u22121${thin}234`);
  assert.equal(counted(1, "row"), "1 row");
  assert.equal(counted(0, "row"), "0 rows");
  assert.equal(quantity(1e-9, "rad"), `1e-9${thin}rad`);
  assert.equal(quantity(null, "rad"), "");
});

test("names become one short line without markup", () => {
  assert.equal(oneLine("a\nb\t\u202ec"), "a b c");
  assert.equal(shorten("abcdefghij", 10), "abcdefghij");
  assert.equal(shorten("abcdefghijk", 5), "ab…jk");
  assert.equal(shorten("one two three four five six", 12), "one two thr…");
  const long = shorten("x".repeat(10000), 40);
  assert.equal(Array.from(long).length, 40);
  assert.equal(Array.from(shorten("\u{1d54f}".repeat(50), 10)).length, 10); // no half characters
  assert.equal(plotText("<b>&amp;</b>"), "&lt;b&gt;&amp;amp;&lt;/b&gt;");
  assert.equal(plotText("a<br>b\nc"), "a&lt;br&gt;b c");
  for (const method of hostileNames().methods) assert.doesNotMatch(plotText(method.name), /[<>\n]/);
});

test("labels of scenes", () => {
  const cases: [string, string][] = [
    ["free_asymmetric{/duration=20}", "free_asymmetric, duration 20 s"],
    ["rope{/duration=0.25,/bodies/10/body/mass=7.8125}", "rope, duration 0.25 s, bodies[10].body.mass 7.8125 kg"],
    ["zeno_ball{/planes/0/restitution=0.5}", "zeno_ball, planes[0].restitution 0.5"],
    ["a{/initial/angular_velocity=[1,2,3]}", "a, initial.angular velocity [1,2,3] rad/s"],
    // other braces, as in names shortened to a hash, stay
    ["plain", "plain"], ["cut{0123456789abcdef}", "cut{0123456789abcdef}"], ["{/}", "{/}"], ["a{/b}", "a{/b}"], ["x\n{/duration=1}", "x , duration 1 s"],
  ];
  for (const [name, label] of cases) assert.equal(sceneLabel(name), label);
});

test("the axis of errors ignores samples 18 decades below the largest", () => {
  assert.deepEqual(errorDecades([1e-30, 2e-9, 0.03]), [-9, -1]);
  assert.deepEqual(errorDecades([null, 0, 1e-3]), [-3, -2]);
  // errors of multiprecision methods
  assert.deepEqual(errorDecades([3e-40, 2e-30]), [-40, -29]);
  assert.equal(errorDecades([null, 0, NaN, Infinity]), null);
});

test("CSV", () => {
  const rows: Cell[][] = [["a,b", 1.5, null], ['say "x"', 1e-300, "two\nlines"], ["=1+1", -2, ""]];
  assert.equal(csv(["name", "a value", "c"], rows), 'name,a value,c\n"a,b",1.5,\n"say ""x""",1e-300,"two\nlines"\n\'=1+1,-2,\n');
});

test("LaTeX", () => {
  assert.equal(latexText("a_b & 50% #1 $x$ {y} ~ ^ \\"), "a\\_b \\& 50\\% \\#1 \\$x\\$ \\{y\\} \\textasciitilde{} \\textasciicircum{} \\textbackslash{}");
  assert.equal(latexNumber("1.59e-5"), "$1.59 \\times 10^{-5}$");
  assert.equal(latexNumber("-3"), "$-3$");
  assert.equal(latexNumber("0.5"), "0.5");
  const text = latex([{ name: "the_method", numeric: false }, { name: "error", numeric: true }], [["rk_4", "1e-9"]], "50% of it");
  assert.match(text, /\\toprule\n {4}the method & error \\\\\n {4}\\midrule\n {4}rk\\_4 & \$1 \\times 10\^\{-9\}\$ \\\\\n {4}\\bottomrule/);
  assert.match(text, /\\begin\{tabular\}\{lr\}/);
  assert.match(text, /\\caption\{50\\% of it\}/);
});

test("filter syntax", () => {
  const columns = ["method", "attitude error", "status", "status_detail"];
  const rows: Cell[][] = [["rk4", 1e-8, "ok", null], ["bullet:default", 1e-3, "failed", "over time"], ["odeint rk4", null, "ok", "x"]];
  const kept = (line: string): number[] => {
    const filter = parseFilter(line, columns);
    assert.equal(filter.fault, "", line);
    return rows.flatMap((row, i) => (filter.matches(row) ? [i] : []));
  };
  assert.deepEqual(kept(""), [0, 1, 2]);
  assert.deepEqual(kept("RK4"), [0, 2]);
  assert.deepEqual(kept("-rk4"), [1]);
  assert.deepEqual(kept('"odeint rk4"'), [2]);
  assert.deepEqual(kept("method:rk4 status:ok"), [0, 2]);
  assert.deepEqual(kept("-method:rk4"), [1]);
  assert.deepEqual(kept("bullet:default"), [1]); // a colon may belong to the word
  assert.deepEqual(kept("attitude_error>1e-9"), [0, 1]);
  assert.deepEqual(kept("att<=1e-8"), [0]);
  assert.deepEqual(kept('"attitude error">=1e-3'), [1]);
  assert.deepEqual(kept("1e-8"), [0]); // words match digits of numbers
  assert.deepEqual(kept("0.001"), [1]);
  assert.deepEqual(kept("status=ok"), [0, 2]);
  assert.deepEqual(kept("status!=ok"), [1]);
  assert.deepEqual(kept("attitude_error=0.001"), [1]);
  assert.deepEqual(kept("rk4 att>1"), []);
  assert.match(parseFilter("nothing>1", columns).fault, /no column is named nothing/);
  assert.match(parseFilter("stat>1", columns).fault, /several columns start with stat/);
  assert.match(parseFilter("attitude_error>much", columns).fault, /attitude_error> needs a number/);
  assert.deepEqual(kept('unclosed "quotation'), []);
});

test("the address stores and restores the state", () => {
  const states: Record<string, string>[] = [{}, { section: "work-precision", scene: "free_asymmetric{/duration=40000}" }, { a: "&=#%+ é\u{1d54f}\n", "work.zoom": "-1.5,2,3,4" }, { "__proto__x": "1", "constructor": "2" }];
  for (const state of states) assert.deepEqual({ ...parseFragment(`#${writeFragment(state)}`) }, state);
  assert.equal(writeFragment({ scene: "b", section: "a", empty: "" }), "section=a&scene=b");
  assert.equal(parseFragment("#__proto__=1&x=2").x, "2");
  assert.equal(({} as Record<string, unknown>).x, undefined);
  assert.equal(parseFragment("#a=%E0%A4%A").a, "%E0%A4%A"); // an invalid escape is kept
  assert.deepEqual({ ...parseFragment("nonsense&=3&&") }, {});
  for (const names of [[], ["a"], ["a,b", "c\\", "\\,", "d"], ["odeint (controlled)"]]) assert.deepEqual(parseList(writeList(names)), names);
});

test("highlights at most twelve methods", () => {
  let lit: number[] = [];
  for (let i = 0; i < 40; ++i) {
    lit = toggleLit(lit, i);
    assert.ok(lit.length <= mostLit);
    assert.equal(lit[lit.length - 1], i);
  }
  assert.deepEqual(lit, [28, 29, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39]); // the oldest are removed
  assert.deepEqual(toggleLit(lit, 30).includes(30), false);
  assert.equal(light(Array.from({ length: 30 }, (_, i) => i % 20)).length, 12);
  assert.deepEqual(light([3, 3, 1]), [3, 1]);
});

test("thinning keeps ends and extremes", () => {
  const y = Array.from({ length: 5000 }, (_, i) => Math.sin(i / 100) + (i === 3210 ? 50 : 0));
  const kept = thinned(y, 200);
  assert.ok(kept.length <= 200);
  assert.equal(kept[0], 0);
  assert.equal(kept[kept.length - 1], 4999);
  assert.ok(kept.includes(3210));
  assert.deepEqual(kept, [...kept].sort((a, b) => a - b));
  assert.deepEqual(thinned([1, 2, 3], 10), [0, 1, 2]);
  assert.deepEqual(thinned([], 10), []);
  assert.ok(thinned(Array.from({ length: 1000 }, () => null), 10).length <= 10);
});

test("Pareto front", () => {
  assert.deepEqual(front([1, 2, 3, 4], [4, 5, 1, 1]), [0, 2]);
  assert.deepEqual(front([], []), []);
});

const row = (values: Partial<Row>): Row => ({
  place: 0, experiment: 0, scene: 0, method: 0, settingKind: 1, setting: 0.01, status: 0, message: "", seconds: 1, evaluations: 1, attitude: 1e-6, floor: 1e-15, floor32: 1e-7, cut: false, formulation: "", ...values,
});

test("limits of a run", () => {
  assert.equal(limitOf(row({}), "binary64").kind, "truncation");
  assert.equal(limitOf(row({ attitude: 0.9e-14 }), "binary64").kind, "floor");
  assert.equal(limitOf(row({ attitude: 1.1e-14 }), "binary64").kind, "truncation");
  assert.equal(limitOf(row({ attitude: 5e-7 }), "binary32").kind, "floor");
  assert.equal(limitOf(row({ attitude: 5e-7 }), "binary64").kind, "truncation");
  assert.equal(limitOf(row({ cut: true, status: 4 }), "binary64").kind, "limit");
  assert.equal(limitOf(row({ status: 2, message: "it blew up" }), "binary64").kind, "instability");
  assert.match(limitOf(row({ status: 1, message: "no joints" }), "binary64").text, /^unsupported: no joints$/);
  assert.equal(limitOf(row({ status: 3 }), "binary64").kind, "tolerance");
  assert.equal(limitOf(row({ status: 4 }), "binary64").kind, "failure");
  assert.equal(limitOf(row({ attitude: null }), "binary64").kind, "unknown");
  assert.equal(limitOf(row({ attitude: 1e-20, floor: null }), "binary64").kind, "truncation");
  assert.equal(settingText(1, 0.001), "step 0.001 s");
  assert.equal(settingText(2, 1e-9), "tolerance 1e-9");
  assert.equal(settingText(0, null), "");
});

test("marks differ until all marks with all dashes are used", () => {
  const seen = new Set(Array.from({ length: marks.length * dashes.length }, (_, i) => JSON.stringify(markOf(i))));
  assert.equal(seen.size, marks.length * dashes.length);
  assert.deepEqual(markOf(-1), markOf(0));
  assert.equal(colorOf({ name: "", label: "", color: "red;x", color_dark: "#ABCDEF" }, true), "#ABCDEF");
  assert.match(colorOf({ name: "", label: "", color: "red;x", color_dark: "" }, false), /^#[0-9a-f]{6}$/);
});

test("rows by scene, and errors in documents", () => {
  const data = richDocument();
  assert.equal(faultOf(data), "");
  const index = new RowIndex(data.rows, data.scenes.length);
  let all = 0;
  data.scenes.forEach((_, s) => {
    for (const place of index.ofScene(s)) {
      assert.equal(rowAt(data.rows, place).scene, s);
      all += 1;
    }
  });
  assert.equal(all, data.rows.count);
  for (const document of [emptyDocument(), hostileNames(), oneRow(), nothingKnown(), manyRows(1000)]) assert.equal(faultOf(document), "");
  assert.match(faultOf(null), /not an object/);
  assert.match(faultOf({ ...data, format: 2 }), /format is 2/);
  assert.match(faultOf({ ...data, tables: undefined }), /no list "tables"/);
  assert.match(faultOf({ ...data, rows: { ...data.rows, seconds: [] } }), /rows\.seconds must have/);
  assert.match(faultOf({ ...data, methods: data.methods.slice(0, 3) }), /rows\.method\[\d+\] is \d+, but there are only 3 methods/);
});

test("a numeric column that the page's code does not name", () => {
  const data = richDocument();
  const wide = { ...data, rows: { ...data.rows, drag: data.rows.energy } };
  assert.equal(faultOf(wide), "");
  assert.match(faultOf({ ...data, rows: { ...data.rows, drag: [1] } }), /rows\.drag must have/);
  const before = resultContent(data);
  const content = resultContent(wide);
  assert.deepEqual(content.columns.filter((column) => !before.columns.some((other) => other.name === column.name)).map((column) => [column.name, column.hidden]), [["drag", true]]);
  const place = content.columns.findIndex((column) => column.name === "drag");
  assert.deepEqual(content.rows.map((line) => line[place]), data.rows.energy);
});

test("sorts numbers before texts before empty cells, in both directions", () => {
  const rows: Cell[][] = [[3], ["b"], [null], [1], ["a"], [2]];
  const places = rows.map((_, i) => i);
  assert.deepEqual(sortedPlaces(rows, places, 0, false), [3, 5, 0, 4, 1, 2]);
  assert.deepEqual(sortedPlaces(rows, places, 0, true), [0, 5, 3, 1, 4, 2]);
});

const curve = (x: number[], y: number[]): Curve => ({ method: 0, variant: "", place: 0, x, y, hover: () => [], failures: [] });
const order = (claimed: number | null, observed: number | null): Order => ({ experiment: 0, scene: 0, method: 0, setting_kind: 1, claimed, observed, points: 3, from: 0.01, to: 0.1 });

test("flags orders that differ from the claimed order", () => {
  assert.equal(isOff(order(4, 3.85)), false);
  assert.equal(isOff(order(4, 3.75)), true);
  assert.equal(isOff(order(4, 4.25)), true);
  assert.equal(isOff(order(null, 1)), false);
  assert.equal(isOff(order(0, 1)), false);
  assert.equal(isAtFloor(order(4, 0.1), curve([0.1, 0.01], [2e-15, 1e-15]), 1e-15), true);
  assert.equal(isAtFloor(order(4, 3), curve([0.1, 0.01], [1e-5, 1e-15]), 1e-15), false);
  for (const guide of guidesOf([curve([0.1, 0.01, 0.001], [1e-2, 1e-6, 1e-10])], [1, 2, 4], String)) {
    const slope = Math.log(guide.y[1]! / guide.y[0]!) / Math.log(guide.x[1]! / guide.x[0]!);
    assert.ok(Math.abs(slope - Number(guide.label)) < 1e-9);
  }
  assert.deepEqual(guidesOf([curve([0.1], [1])], [1], String), []);
  assert.equal(exponentText([1.0123, 0.05]), "1.012 ± 0.050");
  assert.equal(exponentText([2, 0]), "2.00");
  assert.equal(exponentText(undefined), "");
});

test("shares and shades of a stability map", () => {
  const map = { method: 0, map: "m", x_label: "", y_label: "", x: [1, 2], y: [1, 2], outcome: [0, 1, 1, -1], outcomes: ["good", "bad", "worse"] };
  assert.deepEqual(sharesOf(map), { run: 3, shares: [1 / 3, 2 / 3, 0] });
  assert.deepEqual(sharesOf({ ...map, outcome: [-1, -1, -1, -1] }), { run: 0, shares: [0, 0, 0] });
  assert.equal(new Set([0, 1, 2, 3, 4, 5, 6, 7].map((outcome) => shadeOf(outcome, 8))).size, 8);
  assert.deepEqual(tickPlaces([0.001, 0.003, 0.01, 0.03, 0.1], 3), [0, 2, 4]);
  assert.deepEqual(tickPlaces([2, 3, 4, 5, 6], 3), [0, 2, 4]);
});

test("a document embedded in the template is read back unchanged", () => {
  const data = hostileNames();
  const page = embed('<title><!--polhode:title--></title><script id="polhode-data" type="application/gzip"><!--polhode:data--></script>', data);
  assert.match(page, /<title>&lt;script&gt;/);
  const base64 = /application\/gzip">([^<]*)</.exec(page)?.[1] ?? "";
  assert.deepEqual(JSON.parse(gunzipSync(Buffer.from(base64, "base64")).toString()), JSON.parse(JSON.stringify(data)));
});
