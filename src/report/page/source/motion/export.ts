// Pictures and videos of the panes: one canvas with all panes, their captions and labels.

import { element } from "../dom.ts";
import { applyPalette, GIFEncoder, quantize } from "gifenc";

/** Draws the panes of a stage as they are on the screen. */
export function composePanes(stage: HTMLElement, into: HTMLCanvasElement, ratio: number, colors: { ground: string; ink: string }): void {
  const frame = stage.getBoundingClientRect();
  // even sizes, which video encoders require
  const even = (size: number): number => 2 * Math.ceil((size * ratio) / 2);
  const [width, height] = [even(frame.width), even(frame.height)];
  if (into.width !== width || into.height !== height) [into.width, into.height] = [width, height];
  const context = into.getContext("2d");
  if (context === null) return;
  context.fillStyle = colors.ground;
  context.fillRect(0, 0, width, height);
  const place = (one: Element): [number, number, number, number] => {
    const box = one.getBoundingClientRect();
    return [(box.left - frame.left) * ratio, (box.top - frame.top) * ratio, box.width * ratio, box.height * ratio];
  };
  for (const canvas of stage.querySelectorAll("canvas")) context.drawImage(canvas, ...place(canvas));
  context.fillStyle = colors.ink;
  context.textBaseline = "middle";
  for (const text of stage.querySelectorAll("figcaption .name, figcaption .value, .motion-label, .motion-ended:not([hidden])")) {
    const [x, y, , h] = place(text);
    const size = Number.parseFloat(getComputedStyle(text).fontSize) * ratio;
    context.font = `${getComputedStyle(text).fontWeight} ${size}px system-ui, sans-serif`;
    context.fillText(text.textContent ?? "", x, y + h / 2);
  }
}

/** Offers a file for download. */
export function download(content: Blob, name: string): void {
  const address = URL.createObjectURL(content);
  const link = element("a", { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  window.setTimeout(() => URL.revokeObjectURL(address), 10000);
}

/** The video type that this browser can record, or "". */
export function videoType(): string {
  if (typeof MediaRecorder === "undefined" || typeof HTMLCanvasElement.prototype.captureStream !== "function") return "";
  return ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"].find((one) => MediaRecorder.isTypeSupported(one)) ?? "";
}

// a header alone is about 110 bytes
const leastBytes = 2000;

/** Records a canvas at 30 frames per second. */
export class Recording {
  readonly canvas = element("canvas", {});
  private recorder: MediaRecorder | null = null;

  /**
   * Starts once the canvas has its size. Calls `ready` when the encoder has written its first frames: on a slow machine
   * this takes seconds, and a recording that ends before contains no frame.
   */
  start(ready: () => void, done: (video: Blob, ending: string) => void): void {
    const type = videoType();
    const recorder = new MediaRecorder(this.canvas.captureStream(30), { mimeType: type, videoBitsPerSecond: 8e6 });
    const parts: Blob[] = [];
    let bytes = 0;
    recorder.ondataavailable = (event) => {
      parts.push(event.data);
      const before = bytes;
      bytes += event.data.size;
      if (before < leastBytes && bytes >= leastBytes) ready();
    };
    recorder.onstop = () => done(new Blob(parts, { type: type.split(";")[0] ?? type }), type.includes("mp4") ? "mp4" : "webm");
    recorder.start(100);
    this.recorder = recorder;
  }

  stop(): void {
    this.recorder?.stop();
    this.recorder = null;
  }
}

/**
 * Encodes frames as a GIF that repeats. `draw(i)` draws frame i to the canvas; `delay`: ms between frames. `goes()` is
 * called before each frame; null if it returns false.
 */
export async function encodeGif(canvas: HTMLCanvasElement, frames: number, delay: number, draw: (frame: number) => void, goes: () => boolean): Promise<Blob | null> {
  const encoder = GIFEncoder();
  for (let i = 0; i < frames; ++i) {
    if (!goes()) return null;
    draw(i);
    const context = canvas.getContext("2d", { willReadFrequently: true });
    if (context === null) return null;
    const { data, width, height } = context.getImageData(0, 0, canvas.width, canvas.height);
    const palette = quantize(data, 256);
    encoder.writeFrame(applyPalette(data, palette), width, height, { palette, delay });
    // keeps the page responsive
    await new Promise((resolve) => setTimeout(resolve, 0));
  }
  encoder.finish();
  return new Blob([encoder.bytes().slice()], { type: "image/gif" });
}
