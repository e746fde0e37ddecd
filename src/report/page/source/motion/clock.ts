// Maps wall-clock time to time of the motion while the animation plays.

/** Seconds of motion per second at speed 1: real time for durations of 2 to 120 s, else the whole motion in 20 s. */
export function rateOf(duration: number): number {
  return duration >= 2 && duration <= 120 ? 1 : duration / 20;
}

export class Clock {
  time = 0;
  speed = 1;
  playing = false;
  private frame = 0;
  private before = 0;

  constructor(public duration: number, private readonly ticked: () => void, private readonly stopped: () => void) {
    // pauses in hidden tabs
    document.addEventListener("visibilitychange", () => {
      if (document.hidden) this.pause();
    });
  }

  play(): void {
    if (this.playing || !(this.duration > 0)) return;
    if (this.time >= this.duration) this.time = 0;
    this.playing = true;
    this.before = performance.now();
    this.frame = requestAnimationFrame((now) => this.tick(now));
  }

  pause(): void {
    if (!this.playing) return;
    cancelAnimationFrame(this.frame);
    this.playing = false;
    this.stopped();
  }

  go(time: number): void {
    this.time = Math.max(0, Math.min(this.duration, Number.isFinite(time) ? time : 0));
  }

  /** Time step of the step keys, s: 1/30 s of playback at speed 1. */
  step(): number {
    return rateOf(this.duration) / 30;
  }

  private tick(now: number): void {
    if (!this.playing) return;
    // limits the step after slow frames
    const elapsed = Math.min(0.1, Math.max(0, (now - this.before) / 1000));
    this.before = now;
    this.go(this.time + elapsed * this.speed * rateOf(this.duration));
    this.ticked();
    if (this.time >= this.duration) this.pause();
    else this.frame = requestAnimationFrame((next) => this.tick(next));
  }
}
