// A request that an engine or its driver does not support.
export class Unsupported extends Error {}
