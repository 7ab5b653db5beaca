// A plot of uPlot: zoom by dragging, double click shows everything again; a cursor that all plots share.
import uPlot from "uplot";
import type { Plot } from "../store/plots.js";

const shared = uPlot.sync("plots");

export class PlotChart extends HTMLElement {
  private chart: uPlot | null = null;
  private shown = -1;
  private zoomed = false;
  private given: Plot | null = null;
  private span = 60;
  private watcher: ResizeObserver | null = null;
  /** What is shown does not move. */
  frozen = false;
  height = 160;

  set plot(plot: Plot) {
    if (plot === this.given) return;
    this.given = plot;
    this.chart?.destroy();
    this.chart = null;
  }

  /** The last so many seconds; 0: all. */
  set seconds(seconds: number) {
    if (seconds !== this.span) this.zoomed = false;
    this.span = seconds;
    this.shown = -1;
  }

  connectedCallback(): void {
    this.watcher = new ResizeObserver(() => this.chart?.setSize({ width: this.clientWidth, height: this.height }));
    this.watcher.observe(this);
  }

  disconnectedCallback(): void {
    this.watcher?.disconnect();
    this.chart?.destroy();
    this.chart = null;
  }

  private make(plot: Plot): uPlot {
    const css = getComputedStyle(this);
    const color = (name: string): string => css.getPropertyValue(name).trim();
    const axis: uPlot.Axis = { stroke: color("--theme-color-std-text"), grid: { stroke: color("--theme-color-soft-bdr"), width: 1 }, ticks: { stroke: color("--theme-color-soft-bdr") }, font: "12px system-ui" };
    return new uPlot({
      width: this.clientWidth || 600, height: this.height,
      cursor: { sync: { key: shared.key }, drag: { x: true, y: false } },
      legend: { live: true },
      scales: { x: { time: false } },
      hooks: { setSelect: [(chart) => { if (chart.select.width > 0) this.zoomed = true; }] },
      axes: [{ ...axis, values: (_, ticks) => ticks.map((t) => `${t} s`) }, { ...axis, size: 64 }],
      series: [{ label: "Time", value: (_, t) => (t == null ? "–" : `${t.toFixed(3)} s`) },
        { label: plot.name, stroke: color("--theme-color-dynamic"), width: 1.5, paths: uPlot.paths.stepped!({ align: 1 }), points: { show: false }, value: (_, v) => (v == null ? "–" : String(Math.round(v * 1e4) / 1e4)) }],
    }, [plot.times, plot.values], this);
  }

  /** Called with each drawing. */
  update(): void {
    const plot = this.given;
    if (!plot || this.clientWidth === 0) return;
    this.chart ??= this.make(plot);
    const last = plot.times.at(-1) ?? 0;
    if (this.frozen || last === this.shown) return;
    this.shown = last;
    this.chart.setData([plot.times, plot.values], false);
    const from = this.span > 0 ? last - this.span : plot.times[0] ?? 0;
    if (!this.zoomed) this.chart.setScale("x", { min: from, max: Math.max(last, from + 0.001) });
  }

  show_all(): void {
    this.zoomed = false;
    this.shown = -1;
  }
}

customElements.define("plot-chart", PlotChart);
