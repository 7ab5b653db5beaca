// Work that is asked for while it runs is done once more behind it, however often it was asked for.

export class Once {
  private running: Promise<void> | null = null;
  private is_asked_again = false;

  constructor(private readonly work: () => Promise<void>) {}

  /** Resolves when it was done from the beginning after this call. */
  async run(): Promise<void> {
    if (this.running) {
      this.is_asked_again = true;
      return this.running;
    }
    this.running = this.repeat();
    try {
      await this.running;
    } finally {
      this.running = null;
    }
  }

  private async repeat(): Promise<void> {
    do {
      this.is_asked_again = false;
      await this.work();
    } while (this.is_asked_again);
  }
}
