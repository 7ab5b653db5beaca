// A plot of uPlot: zoom by dragging, double click shows everything again; a crosshair that all plots share, and two cursors that stay.
import uPlot from "uplot";
import { rounded, type Cursors } from "../store/cursors.js";
import type { Plot } from "../store/plots.js";

const shared = uPlot.sync("plots");
const least_span = 10;  // s
const cursor_colors = { a: "#e07b00", b: "#8a3ab9" };

export class PlotChart extends HTMLElement {
  private chart: uPlot | null = null;
  private shown = -1;
  private zoomed = false;
  private given: Plot | null = null;
  private span = 60;
  private scheme = "";
  private drawn_cursors = "";
  private watcher: ResizeObserver | null = null;
  /** What is shown does not move. */
  frozen = false;
  height = 160;
  is_small = false;
  cursors: Cursors | null = null;
  /** Somebody has clicked at this time; `second`: with Shift. */
  placed: ((t: number, second: boolean) => void) | null = null;

  set plot(plot: Plot) {
    if (plot === this.given) return;
    this.given = plot;
    this.end();
  }

  /** The last so many seconds; 0: all. */
  set seconds(seconds: number) {
    if (seconds === this.span) return;
    this.zoomed = false;
    this.span = seconds;
    this.shown = -1;
  }

  connectedCallback(): void {
    this.watcher = new ResizeObserver(() => this.chart?.setSize({ width: this.clientWidth, height: this.height }));
    this.watcher.observe(this);
  }

  disconnectedCallback(): void {
    this.watcher?.disconnect();
    this.end();
  }

  private end(): void {
    this.chart?.destroy();
    this.chart = null;
    this.shown = -1;
  }

  private draw_cursors(chart: uPlot): void {
    const { cursors } = this;
    if (!cursors) return;
    const { ctx, bbox } = chart;
    ctx.save();
    for (const name of ["a", "b"] as const) {
      const t = cursors[name];
      if (t === null) continue;
      const x = Math.round(chart.valToPos(t, "x", true));
      if (x < bbox.left || x > bbox.left + bbox.width) continue;
      ctx.strokeStyle = ctx.fillStyle = cursor_colors[name];
      ctx.lineWidth = 1.5 * devicePixelRatio;
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
      ctx.font = `bold ${12 * devicePixelRatio}px system-ui`;
      ctx.fillText(name.toUpperCase(), x + 4 * devicePixelRatio, bbox.top + 12 * devicePixelRatio);
    }
    ctx.restore();
  }

  private make(plot: Plot): uPlot {
    const css = getComputedStyle(this);
    const color = (name: string): string => css.getPropertyValue(name).trim();
    const axis: uPlot.Axis = { stroke: color("--theme-color-std-text"), grid: { stroke: color("--theme-color-soft-bdr"), width: 1 }, ticks: { stroke: color("--theme-color-soft-bdr") }, font: "12px system-ui" };
    const chart = new uPlot({
      width: this.clientWidth || 600, height: this.height,
      cursor: { sync: { key: shared.key }, drag: { x: true, y: false } },
      legend: { show: !this.is_small, live: true },
      scales: { x: { time: false } },
      hooks: { setSelect: [(one) => { if (one.select.width > 0) this.zoomed = true; }], draw: [(one) => this.draw_cursors(one)] },
      axes: [{ ...axis, values: (_, ticks) => ticks.map((t) => `${t} s`), size: this.is_small ? 26 : 32 }, { ...axis, size: 64 }],
      series: [{ label: "Time", value: (_, t) => (t == null ? "–" : `${t.toFixed(3)} s`) },
        { label: plot.name, stroke: color("--chart-line"), width: 2, paths: uPlot.paths.stepped!({ align: 1 }), points: { show: false }, value: (_, v) => (v == null ? "–" : rounded(v)) }],
    }, [plot.times, plot.values], this);
    // A click that is no drag places a cursor.
    let begun = 0;
    chart.over.addEventListener("mousedown", (event) => { begun = event.clientX; });
    chart.over.addEventListener("click", (event) => { if (this.placed && Math.abs(event.clientX - begun) < 4) this.placed(chart.posToVal(event.offsetX, "x"), event.shiftKey); });
    return chart;
  }

  /** Called with each drawing. */
  update(): void {
    const plot = this.given;
    if (!plot || this.clientWidth === 0) return;
    const scheme = document.documentElement.dataset["ixColorSchema"] ?? "";
    if (scheme !== this.scheme) this.end();
    this.scheme = scheme;
    this.chart ??= this.make(plot);
    if (this.chart.height !== this.height) this.chart.setSize({ width: this.clientWidth, height: this.height });
    const last = plot.times.at(-1) ?? 0;
    const cursors = `${this.cursors?.a} ${this.cursors?.b}`;
    if (cursors !== this.drawn_cursors) {
      this.drawn_cursors = cursors;
      this.chart.redraw(false);
    }
    if (this.frozen || last === this.shown) return;
    this.shown = last;
    this.chart.setData([plot.times, plot.values], false);
    const first = plot.times[0] ?? 0;
    // Of a plot that has just begun, ten seconds are enough.
    const from = this.span > 0 ? Math.max(last - this.span, Math.min(first, last - least_span)) : first;
    if (!this.zoomed) this.chart.setScale("x", { min: from, max: Math.max(last, from + 0.001) });
    else this.chart.redraw();
  }

  show_all(): void {
    this.zoomed = false;
    this.shown = -1;
  }
}

customElements.define("plot-chart", PlotChart);
