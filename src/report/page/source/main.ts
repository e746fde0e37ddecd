// Entry point of the page: decodes the document and renders each section when the reader scrolls near it.

import { copyText, element, fill } from "./dom.ts";
import type { ReportData } from "./data.ts";
import { readDocument } from "./decode.ts";
import { faultOf, RowIndex } from "./rows.ts";
import { Page } from "./state.ts";
import { oneLine, sceneLabel, shorten } from "./text.ts";
import { chosenScene, sceneName, type Section, type Tools } from "./tools.ts";
import { sections } from "./sections/all.ts";

const byId = (id: string): HTMLElement => document.getElementById(id) as HTMLElement;

interface Placed {
  section: Section;
  host: HTMLElement;
  heading: HTMLElement;
  link: HTMLAnchorElement;
  drawn: boolean;
}

function header(page: Page, tools: Tools | null): void {
  const bar = byId("tools");
  const theme = element("button", { type: "button", class: "theme" });
  const show = (): void => {
    const dark = page.dark();
    theme.textContent = dark ? "Light" : "Dark";
    theme.title = dark ? "Switch to the light theme" : "Switch to the dark theme";
  };
  theme.addEventListener("click", () => page.set({ theme: page.dark() ? "light" : "dark" }));
  page.onTheme(show);
  show();
  const link = element("button", {
    type: "button", title: "Copy a link to the current view",
    onclick: () => {
      const address = page.address();
      void copyText(address).then((done) => page.announce(done ? "link copied" : "cannot copy; the link is in the address bar"));
      link.textContent = "Copied";
      window.setTimeout(() => (link.textContent = "Copy link"), 1500);
    },
  }, "Copy link");
  if (tools !== null && tools.data.scenes.length > 1) {
    const { data } = tools;
    const select = element("select", { id: "scene", onchange: () => page.set({ scene: select.value }) },
      ...data.scenes.map((scene) => element("option", { value: scene.name, title: oneLine(scene.name).slice(0, 500) }, shorten(sceneLabel(scene.name), 56))));
    const follow = (): void => {
      select.selectedIndex = chosenScene(tools);
    };
    page.onState(follow);
    follow();
    bar.append(element("label", { class: "choice scene" }, element("span", {}, "Scene"), select));
  }
  bar.append(link, theme);
}

function draw(placed: Placed, tools: Tools): void {
  if (placed.drawn) return;
  placed.drawn = true;
  placed.host.classList.remove("waiting");
  try {
    placed.section.render(placed.host, tools);
  } catch (fault) {
    console.error(fault);
    placed.host.append(element("p", { class: "fault" }, `This section cannot be shown: ${fault instanceof Error ? fault.message : String(fault)}`));
  }
}

/** Builds sections and navigation, and renders sections when they come near. */
function build(page: Page, tools: Tools): void {
  const content = byId("content");
  const navigation = byId("sections");
  const all: Placed[] = sections
    .filter((section) => section.present(tools.data))
    .map((section) => {
      const heading = element("h2", { id: `${section.name}-heading`, tabindex: -1 }, section.title);
      const host = element("div", { class: "body waiting" });
      const link = element("a", { href: `#section=${section.name}` }, section.title);
      return { section, host, heading, link, drawn: false };
    });
  let still = 0; // ms; until this time, scrolling was caused by the page and does not change the state
  const go = (placed: Placed, focus: boolean): void => {
    draw(placed, tools);
    still = performance.now() + 700;
    mark(placed);
    const there = (): void => placed.heading.scrollIntoView({ block: "start" });
    there();
    if (focus) placed.heading.focus({ preventScroll: true });
    // sections rendered above during scrolling may move the heading
    window.setTimeout(there, 250);
  };
  const mark = (placed: Placed): void => {
    for (const one of all) {
      if (one === placed) one.link.setAttribute("aria-current", "true");
      else one.link.removeAttribute("aria-current");
    }
    const box = placed.link.getBoundingClientRect();
    const frame = navigation.getBoundingClientRect();
    if (box.left < frame.left || box.right > frame.right) navigation.scrollLeft += box.left - frame.left - 40;
  };
  for (const placed of all) {
    placed.link.addEventListener("click", (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey) return;
      event.preventDefault();
      page.set({ section: placed.section.name });
      go(placed, true);
    });
  }
  fill(navigation, element("ul", {}, ...all.map((placed) => element("li", {}, placed.link))));
  fill(content, ...all.map((placed) =>
    element("section", { id: `section-${placed.section.name}`, "aria-labelledby": placed.heading.id }, placed.heading, placed.host)));

  const asked = (): Placed | undefined => all.find((placed) => placed.section.name === page.get("section"));
  if (typeof IntersectionObserver === "undefined") for (const placed of all) draw(placed, tools);
  else {
    const near = new IntersectionObserver((entries) => {
      for (const entry of entries) {
        const placed = all.find((one) => one.host === entry.target);
        if (!entry.isIntersecting || placed === undefined) continue;
        near.unobserve(entry.target);
        draw(placed, tools);
      }
    }, { rootMargin: "500px 0px" });
    for (const placed of all) near.observe(placed.host);
  }
  let waiting = false;
  window.addEventListener("scroll", () => {
    if (waiting) return;
    waiting = true;
    window.setTimeout(() => {
      waiting = false;
      if (performance.now() < still) return;
      const line = 0.3 * window.innerHeight;
      const above = all.filter((placed) => placed.heading.getBoundingClientRect().top < line);
      const here = above[above.length - 1] ?? all[0];
      if (here === undefined) return;
      mark(here);
      page.set({ section: here === all[0] ? "" : here.section.name });
    }, 120);
  }, { passive: true });
  window.addEventListener("beforeprint", () => {
    for (const placed of all) draw(placed, tools);
  });
  page.onFollow(() => {
    const placed = asked();
    if (placed !== undefined) go(placed, true);
  });
  const first = asked();
  if (first !== undefined) go(first, false);
  else if (all[0] !== undefined) mark(all[0]);
}

async function begin(): Promise<void> {
  const page = new Page(byId("announcements"));
  // after the first paint
  await new Promise((resolve) => requestAnimationFrame(() => window.setTimeout(resolve, 0)));
  try {
    const holder = document.getElementById("polhode-data");
    const value = await readDocument(holder);
    holder?.remove();
    const fault = faultOf(value);
    if (fault !== "") throw new Error(`${fault}; create the page again with this version of polhode`);
    const data = value as ReportData;
    const tools: Tools = { data, page, index: new RowIndex(data.rows, data.scenes.length) };
    // all sections show the same scene, even if the address has no scene or an unknown one
    if (data.scenes.length > 0) page.set({ scene: sceneName(tools, chosenScene(tools)) });
    header(page, tools);
    build(page, tools);
    performance.mark("polhode-ready");
    document.documentElement.dataset.ready = "yes";
  } catch (fault) {
    header(page, null);
    fill(byId("content"), element("p", { class: "fault", role: "alert" }, `The page cannot be shown: ${fault instanceof Error ? fault.message : String(fault)}`));
    document.documentElement.dataset.ready = "no";
  }
}

void begin();
