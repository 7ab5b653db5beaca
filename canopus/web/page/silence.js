// Whether a run still says something: it sends a state four times a second, a paused one, too. One that hangs, or a machine that sleeps, keeps its
// connection, and what is shown of it would look alive.

const longest = 3000;  // ms without a message

export class Silence {
  constructor() {
    this.heard_at = 0;
    this.is_on = false;
  }

  ends() {
    this.heard_at = performance.now();
  }

  /// Since the last look. A page that nobody sees gets its messages late.
  has_changed() {
    if (document.hidden || this.is_on === (performance.now() - this.heard_at > longest)) return false;
    this.is_on = !this.is_on;
    return true;
  }
}
