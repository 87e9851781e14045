(* SPDX-License-Identifier: BSD-3-Clause *)
(** * Tolerances: how far the points of a body may stray, seen from a frame above it

    As doc/TUBES.md derives it: places change one after the other, the one next to that frame first. So a point moves at
    each place as far as the motion has it from there. *)
From Coq Require Import Reals ZArith Lia Lra Bool List.
From FclArtic Require Import Statement Numbers Trig Frames Enclose Reach.
Import ListNotations.
Open Scope R_scope.

(** ** Turns by different angles *)

Definition isometry (E : vec -> vec) : Prop := forall x y, norm (sub (E x) (E y)) = norm (sub x y).

Ltac coords := unfold turn, turned, sub, add, scale, cross, dot; cbn [vx vy vz].

Lemma norm_of_dots a b : dot a a = dot b b -> norm a = norm b.
Proof. unfold norm. intros ->. reflexivity. Qed.
Lemma norm_square a : norm a * norm a = dot a a.
Proof. apply sqrt_sqrt, dot_nonneg. Qed.
Lemma norm_le_of_squares a r : 0 <= r -> dot a a <= r * r -> norm a <= r.
Proof.
  intros Hr H. unfold norm. rewrite <- (sqrt_square r) by exact Hr. apply sqrt_le_1_alt. exact H.
Qed.
Lemma norm_opp a : norm (scale (-1) a) = norm a.
Proof. apply norm_of_dots. unfold dot, scale; cbn [vx vy vz]. ring. Qed.
Lemma norm_zero : norm (Vec 0 0 0) = 0.
Proof. unfold norm, dot; cbn [vx vy vz]. replace (_ + _ + _) with 0 by ring. apply sqrt_0. Qed.
Lemma sub_add_zero x : sub x (Vec 0 0 0) = x.
Proof. destruct x. coords. f_equal; ring. Qed.

Lemma cross_short k x : dot k k = 1 -> norm (cross k x) <= norm x.
Proof.
  intros K. unfold norm. apply sqrt_le_1_alt.
  assert (E : dot (cross k x) (cross k x) = dot k k * dot x x - dot k x * dot k x)
    by (unfold dot, cross; cbn [vx vy vz]; ring). rewrite E, K. nra.
Qed.

Lemma turn_is_turned k a x : turn k a x = turned k (sin a) (cos a) x.
Proof. reflexivity. Qed.

Lemma turn_zero k x : turn k 0 x = x.
Proof. destruct k, x. coords. rewrite cos_0, sin_0. f_equal; ring. Qed.

Lemma turn_isometry k a : dot k k = 1 -> isometry (turn k a).
Proof.
  intros K x y. replace (sub (turn k a x) (turn k a y)) with (turned k (sin a) (cos a) (sub x y)).
  - apply norm_of_dots, turned_keeps_dot; [exact K|]. rewrite <- (sin2_cos2 a). reflexivity.
  - destruct k, x, y. coords. f_equal; ring.
Qed.

Lemma sin_below x : Rabs (sin x) <= Rabs x.
Proof.
  assert (P : forall y, 0 <= y -> Rabs (sin y) <= y).
  { intros y Hy. destruct (Rle_lt_dec y 1) as [L|G].
    - pose proof (sin_small_pos y ltac:(lra)) as [S1 S2]. assert (Q : 0 <= y * y <= 1) by nra.
      assert (0 <= y * y * y <= y) by nra.
      assert (y * y * y * y * y <= y * y * y) by (replace (y * y * y * y * y) with (y * y * y * (y * y)) by ring; nra).
      apply Rabs_le. lra.
    - pose proof (SIN_bound y). apply Rabs_le. lra. }
  destruct (Rle_lt_dec 0 x) as [L|G]; [rewrite (Rabs_right x) by lra; apply P; exact L|].
  rewrite <- (Rabs_Ropp x), <- Rabs_Ropp, <- sin_neg, (Rabs_right (- x)) by lra. apply P. lra.
Qed.

(** The chord of an arc e on a circle of radius |k x x|. *)
Lemma turn_moves k a e most x : dot k k = 1 -> Rabs e <= most ->
  norm (sub (turn k (a + e) x) (turn k a x)) <= Rmin most 2 * norm (cross k x).
Proof.
  intros K He.
  assert (C : 0 <= Rmin most 2) by (pose proof (Rabs_pos e); apply Rmin_glb; lra).
  assert (SQ : (cos (a + e) - cos a) * (cos (a + e) - cos a) + (sin (a + e) - sin a) * (sin (a + e) - sin a) =
    2 * sin (e / 2) * (2 * sin (e / 2))).
  { replace (a + e) with ((a + e / 2) + e / 2) by field. replace a with ((a + e / 2) - e / 2) at 2 4 6 8 by field.
    set (p := a + e / 2). set (h := e / 2). rewrite cos_plus, cos_minus, sin_plus, sin_minus.
    pose proof (sin2_cos2 p) as Q. unfold Rsqr in Q.
    transitivity (4 * (sin h * sin h) * (sin p * sin p + cos p * cos p)); [ring|]. rewrite Q. ring. }
  assert (S : 2 * sin (e / 2) * (2 * sin (e / 2)) <= Rmin most 2 * Rmin most 2).
  { assert (B : Rabs (2 * sin (e / 2)) <= Rmin most 2).
    { rewrite Rabs_mult, (Rabs_right 2) by lra. apply Rmin_glb.
      - pose proof (sin_below (e / 2)) as L. unfold Rdiv in L. rewrite (Rabs_mult e), (Rabs_right (/ 2)) in L by lra.
        unfold Rdiv. lra.
      - pose proof (SIN_bound (e / 2)). assert (Rabs (sin (e / 2)) <= 1) by (apply Rabs_le; lra). lra. }
    apply abs_in in B. nra. }
  apply norm_le_of_squares; [apply Rmult_le_pos; [exact C | apply norm_nonneg]|].
  replace (Rmin most 2 * norm (cross k x) * (Rmin most 2 * norm (cross k x))) with
    (Rmin most 2 * Rmin most 2 * dot (cross k x) (cross k x)) by (rewrite <- norm_square; ring).
  apply Rle_trans with (2 * sin (e / 2) * (2 * sin (e / 2)) * dot (cross k x) (cross k x)).
  2:{ apply Rmult_le_compat_r; [apply dot_nonneg | exact S]. }
  rewrite <- SQ. apply Req_le.
  set (dc := cos (a + e) - cos a). set (ds := sin (a + e) - sin a).
  replace (sub (turn k (a + e) x) (turn k a x)) with
    (add (scale dc (sub x (scale (dot k x) k))) (scale ds (cross k x)))
    by (destruct k, x; unfold dc, ds; coords; f_equal; ring).
  transitivity (dc * dc * (dot x x - 2 * (dot k x * dot k x) + dot k x * dot k x * dot k k) +
    ds * ds * dot (cross k x) (cross k x)).
  - destruct k, x. coords. ring.
  - replace (dot (cross k x) (cross k x)) with (dot k k * dot x x - dot k x * dot k x)
      by (unfold dot, cross; cbn [vx vy vz]; ring). rewrite K. ring.
Qed.

Lemma small_turn_isometry most D : small_turn most D -> isometry D.
Proof. intros (k & a & K & _ & E) x y. rewrite !E. apply turn_isometry. exact K. Qed.

Lemma small_turn_moves most D x : small_turn most D -> norm (sub (D x) x) <= Rmin most 2 * norm x.
Proof.
  intros (k & a & K & A & E). rewrite E.
  rewrite <- (turn_zero k x) at 2. replace a with (0 + a) by ring.
  eapply Rle_trans; [apply (turn_moves k 0 a most x K A)|].
  apply Rmult_le_compat_l; [pose proof (Rabs_pos a); apply Rmin_glb; lra | apply cross_short; exact K].
Qed.

Lemma dot_determines a b : (forall u, dot u a = dot u b) -> a = b.
Proof.
  intros H. pose proof (H (Vec 1 0 0)) as X. pose proof (H (Vec 0 1 0)) as Y. pose proof (H (Vec 0 0 1)) as Z0.
  destruct a as [a1 a2 a3], b as [b1 b2 b3]. unfold dot in *; cbn [vx vy vz] in *. f_equal; lra.
Qed.

Lemma step_onto s st E : holds_step s st E -> forall y, exists x, E x = y.
Proof.
  intros [km snm csm k sn cs F Hk Hsn Hcs K S HF | km wm k way F Hk Hw HF | um cm u c F Hu Hc K HF
         | a b c pm m p F Ha Hb Hc Hp R HF] y.
  - exists (turned k (- sn) cs y). rewrite HF. apply dot_determines. intros v.
    rewrite dot_turned, turned_keeps_dot; [reflexivity | exact K | rewrite <- S; ring].
  - exists (add y (scale (- way) k)). rewrite HF. destruct y as [y1 y2 y3]. unfold add, scale; cbn [vx vy vz]. f_equal; ring.
  - exists (spun (scale (-1) u) c y). rewrite HF. apply dot_determines. intros v.
    rewrite dot_spun, spun_keeps_dot; [reflexivity|]. rewrite <- K. unfold dot, scale; cbn [vx vy vz]. ring.
  - exists (apply (transpose m) (sub y p)). rewrite HF.
    replace (apply m (apply (transpose m) (sub y p))) with (sub y p).
    + destruct y as [y1 y2 y3], p as [p1 p2 p3]. unfold sub, add, scale; cbn [vx vy vz]. f_equal; ring.
    + apply dot_determines. intros v. rewrite dot_apply.
      rewrite (rotation_keeps_dot (transpose m)) by (apply transpose_is_rotation; exact R). reflexivity.
Qed.

Definition onto (E : vec -> vec) : Prop := forall y, exists x, E x = y.

Lemma turn_onto k a : dot k k = 1 -> onto (turn k a).
Proof.
  intros K y. exists (turned k (- sin a) (cos a) y). rewrite turn_is_turned. apply dot_determines. intros v.
  pose proof (sin2_cos2 a) as S. unfold Rsqr in S. rewrite dot_turned, turned_keeps_dot; [reflexivity | exact K | rewrite <- S; ring].
Qed.

Lemma small_turn_onto most D : small_turn most D -> onto D.
Proof. intros (k & a & K & _ & E) y. destruct (turn_onto k a K y) as [x <-]. exists x. apply E. Qed.

Lemma shifted_onto a : onto (fun x => add x a).
Proof. intros y. exists (sub y a). destruct y, a. coords. f_equal; ring. Qed.

(** ** What tolerances give at a place

    There a point moves by [g_slide] at most, and [g_chord] times its distance from the axis [g_at] through the origin,
    or from the point [g_at]. *)
Record give := Give { g_axis : bool; g_at : tvec; g_chord : Z; g_slide : Z }.

Definition arm (axis : bool) (c x : vec) : vec := if axis then cross c x else sub x c.

Definition moves_by (s : R) (g : option give) (E E' : vec -> vec) : Prop :=
  match g with
  | None => forall x, E' x = E x
  | Some g => exists c, holdsv (g_at g) s c /\ (g_axis g = true -> dot c c = 1) /\ 0 <= V (g_chord g) /\
      forall x, norm (sub (E' x) (E x)) <= V (g_slide g) + V (g_chord g) * norm (arm (g_axis g) c x)
  end.

(** E takes x to where the motion has it, E' to where it may be. *)
Inductive strays (s : R) : list step -> list (option give) -> (vec -> vec) -> (vec -> vec) -> Prop :=
  | strays_no gs E E' : (forall x, E x = x) -> (forall x, E' x = x) -> strays s [] gs E E'
  | strays_first st sts g gs E E' M M' N N' : holds_step s st E -> isometry E' -> onto E' -> moves_by s g E E' ->
      strays s sts gs M M' -> (forall x, N x = E (M x)) -> (forall x, N' x = E' (M' x)) ->
      strays s (st :: sts) (g :: gs) N N'.

Definition abs_up (x : number) : Z := let (c, r) := enclose x in (Z.abs c + r)%Z.
Definition listed (list : list (nat * number)) (i : nat) : option number :=
  option_map snd (find (fun e => Nat.eqb (fst e) i) list).
Definition listed_up (list : list (nat * number)) (i : nat) : Z :=
  match listed list i with Some x => Z.max 0 (number_up x) | None => 0%Z end.

(** 2 sin(min(a, pi) / 2) is at most a, and at most 2. *)
Definition chord_of (angle : Z) : Z := Z.min angle (2 * one).

Definition pose_give (t : option pose_tolerance) : option give :=
  option_map (fun t => Give false (tm_point (pivot t)) (chord_of (Z.max 0 (number_up (most_angle t)))) (number_up (most_shift t))) t.

(** Of each step of an element (steps_of). *)
Definition element_gives (t : tolerances) (x : sstate) (e : element) : list (option give) :=
  match e with
  | Turn a v m c =>
      [match listed (of_variables t) v with
       | None => None
       | Some _ => Some (Give true (axis_tm a) (chord_of (mulup (abs_up m) (listed_up (of_variables t) v))) 0)
       end]
  | Slide a v m c =>
      [match listed (of_variables t) v, listed (of_vectors t) v with
       | None, None => None
       | _, _ => Some (Give false origin_tm 0
           (mulup (abs_up m) (listed_up (of_variables t) v + listed_up (of_vectors t) v)))
       end]
  | Rotate v =>
      match listed (of_rotations t) v with
      | None => None
      | Some _ => Some (Give false origin_tm (chord_of (listed_up (of_rotations t) v)) 0)
      end :: map (fun _ => None) (starts x v)
  end.

(** Of each frame but the world, and of each step of it. *)
Definition frame_gives (w : world) (x : sstate) (i : nat) (f : frame) : list (option give) :=
  pose_give (frame_tolerance w (S i)) :: flat_map (element_gives (off w) x) (elements f).
Fixpoint all_gives (w : world) (x : sstate) (i : nat) (fs : list frame) : list (list (option give)) :=
  match fs with [] => [] | f :: rest => frame_gives w x i f :: all_gives w x (S i) rest end.
Definition gives_of (w : world) (p : spiece) : list (list (option give)) := all_gives w (Sstate [] (s_starts p)) 0 (frames w).
Definition body_give (w : world) (b : body) : option give := pose_give (body_tolerance w b).

Lemma abs_up_ok x : Rabs (real x) <= V (abs_up x).
Proof.
  unfold abs_up. pose proof (enclose_ok x) as H. destruct (enclose x) as [c r]. cbn [fst snd] in H. rewrite V_add, V_abs.
  replace (real x) with (V c + (real x - V c)) by ring. eapply Rle_trans; [apply Rabs_triang|]. lra.
Qed.

Lemma listed_up_ok list i : most list i <= V (listed_up list i).
Proof.
  unfold most, listed_up, listed. destruct (find _ list) as [e|]; cbn [option_map].
  - eapply Rle_trans; [apply number_up_ok | apply V_max].
  - rewrite V_0. lra.
Qed.
Lemma listed_none list i : listed list i = None -> most list i = 0.
Proof. unfold most, listed. destruct (find _ list); [discriminate | reflexivity]. Qed.

Lemma chord_of_ok r z : r <= V z -> Rmin r 2 <= V (chord_of z).
Proof.
  intros H. unfold chord_of. destruct (Z.min_spec z (2 * one)) as [[_ ->]|[_ ->]].
  - eapply Rle_trans; [apply Rmin_l | exact H].
  - eapply Rle_trans; [apply Rmin_r|]. apply Req_le. unfold V. rewrite mult_IZR, Rmult_assoc, (Rmult_comm (IZR one)), ulp_one. ring.
Qed.

Lemma V_nonneg z : (0 <= z)%Z -> 0 <= V z.
Proof. intros H. rewrite <- V_0. apply V_le. exact H. Qed.

Lemma chord_of_nonneg z : (0 <= z)%Z -> 0 <= V (chord_of z).
Proof. intros H. apply V_nonneg. unfold chord_of, one. lia. Qed.

Lemma listed_up_nonneg list i : (0 <= listed_up list i)%Z.
Proof. unfold listed_up. destruct (listed list i); lia. Qed.

Lemma enclose_radius x : (0 <= snd (enclose x))%Z.
Proof. unfold enclose. destruct (Z.leb _ _); cbn [snd]; lia. Qed.

Lemma abs_up_nonneg x : (0 <= abs_up x)%Z.
Proof. unfold abs_up. pose proof (enclose_radius x). destruct (enclose x) as [c r]. cbn [snd] in *. lia. Qed.

Lemma mulup_nonneg a b : (0 <= a)%Z -> (0 <= b)%Z -> (0 <= mulup a b)%Z.
Proof.
  intros Ha Hb. unfold mulup, mulz. rewrite Z.shiftr_div_pow2 by lia.
  assert (0 <= a * b / 2 ^ 64)%Z by (apply Z.div_pos; [apply Z.mul_nonneg_nonneg; assumption | reflexivity]). lia.
Qed.

Lemma times_error m e list i : Rabs e <= most list i -> Rabs (real m * e) <= V (mulup (abs_up m) (listed_up list i)).
Proof.
  intros H. apply mulup_abs; [apply abs_up_ok|]. eapply Rle_trans; [exact H | apply listed_up_ok].
Qed.

Lemma no_error e : Rabs e <= 0 -> e = 0.
Proof. intros H. apply abs_in in H. lra. Qed.

Lemma no_norm u : norm u <= 0 -> u = Vec 0 0 0.
Proof.
  intros H. pose proof (norm_nonneg u). pose proof (norm_square u) as S. replace (norm u) with 0 in S by lra.
  destruct u as [a b c]. unfold dot in S; cbn [vx vy vz] in S.
  assert (a = 0 /\ b = 0 /\ c = 0) as (-> & -> & ->); [|reflexivity]. repeat split; nra.
Qed.

(** Translations don't change distances. *)
Lemma shifted_isometry a : isometry (fun x => add x a).
Proof. intros x y. f_equal. unfold sub, add, scale; cbn [vx vy vz]. f_equal; ring. Qed.

Lemma pose_off_isometry t G : pose_off t G -> isometry G.
Proof.
  destruct t as [t|]; cbn [pose_off].
  - intros (D & u & HD & _ & E) x y. rewrite !E. set (p := point (pivot t)).
    transitivity (norm (sub (D (sub x p)) (D (sub y p)))).
    + f_equal. unfold sub, add, scale; cbn [vx vy vz]. f_equal; ring.
    + rewrite (small_turn_isometry _ _ HD). f_equal. unfold sub, add, scale; cbn [vx vy vz]. f_equal; ring.
  - intros E x y. rewrite !E. reflexivity.
Qed.

Lemma pose_off_onto t G : pose_off t G -> onto G.
Proof.
  destruct t as [t|]; cbn [pose_off].
  - intros (D & u & HD & _ & E) y. set (p := point (pivot t)) in *.
    destruct (small_turn_onto _ _ HD (sub (sub y u) p)) as [z Z0]. exists (add z p). rewrite E.
    replace (sub (add z p) p) with z by (destruct z, p; coords; f_equal; ring). rewrite Z0.
    destruct y, u, p. coords. f_equal; ring.
  - intros E y. exists y. apply E.
Qed.

Lemma pose_off_moves s t G O : isometry O -> pose_off t G -> moves_by s (pose_give t) O (fun x => O (G x)).
Proof.
  intros HO. destruct t as [t|]; cbn [pose_off pose_give option_map moves_by g_axis g_at g_chord g_slide].
  - intros (D & u & HD & Hu & E). exists (point (pivot t)). split; [apply holdsv_point|]. split; [discriminate|].
    split; [apply chord_of_nonneg; lia|]. intros x. rewrite HO, E. cbn [arm]. set (p := point (pivot t)).
    replace (sub (add (add p (D (sub x p))) u) x) with (add u (sub (D (sub x p)) (sub x p)))
      by (unfold sub, add, scale; cbn [vx vy vz]; f_equal; ring).
    eapply Rle_trans; [apply triangle|]. apply Rplus_le_compat.
    + eapply Rle_trans; [exact Hu | apply number_up_ok].
    + eapply Rle_trans; [apply (small_turn_moves _ _ _ HD)|]. apply Rmult_le_compat_r; [apply norm_nonneg|].
      apply chord_of_ok. eapply Rle_trans; [apply number_up_ok | apply V_max].
  - intros E x. rewrite E. reflexivity.
Qed.

Lemma step_keeps s st E x y : holds_step s st E -> norm (sub (E x) (E y)) = norm (sub x y).
Proof.
  intros [km snm csm k sn cs F Hk Hsn Hcs K S HF | km wm k way F Hk Hw HF | um cm u c F Hu Hc K HF
         | a b c pm m p F Ha Hb Hc Hp R HF]; rewrite !HF.
  - replace (sub (turned k sn cs x) (turned k sn cs y)) with (turned k sn cs (sub x y)).
    + apply norm_of_dots, turned_keeps_dot; assumption.
    + destruct k as [k1 k2 k3], x as [x1 x2 x3], y as [y1 y2 y3]. unfold turned, sub, add, scale, cross, dot; cbn [vx vy vz]. f_equal; ring.
  - f_equal. destruct x as [x1 x2 x3], y as [y1 y2 y3]. unfold sub, add, scale; cbn [vx vy vz]. f_equal; ring.
  - replace (sub (spun u c x) (spun u c y)) with (spun u c (sub x y)).
    + apply norm_of_dots, spun_keeps_dot. exact K.
    + destruct u as [k1 k2 k3], x as [x1 x2 x3], y as [y1 y2 y3]. unfold spun, sub, add, scale, cross, dot; cbn [vx vy vz]. f_equal; ring.
  - replace (sub (add (apply m x) p) (add (apply m y) p)) with (apply m (sub x y)).
    + apply norm_of_dots, rotation_keeps_dot. exact R.
    + destruct p as [p1 p2 p3], x as [x1 x2 x3], y as [y1 y2 y3]. unfold apply, sub, add, scale, dot; cbn [vx vy vz]. f_equal; ring.
Qed.

Lemma steps_keep s sts E : holds_steps s sts E -> forall x y, norm (sub (E x) (E y)) = norm (sub x y).
Proof.
  induction 1 as [E HE | st sts E M N HS HM IH HN]; intros x y; [rewrite !HE; reflexivity|].
  rewrite !HN, (step_keeps s st E _ _ HS). apply IH.
Qed.

Lemma strays_same s sts gs M M' N N' : strays s sts gs M M' -> (forall x, N x = M x) -> (forall x, N' x = M' x) ->
  strays s sts gs N N'.
Proof.
  intros [gs' E E' HE HE' | st sts' g gs' E E' L L' K K' HS HI HO HG HL HK HK'] HN HN'.
  - apply strays_no; intros; [rewrite HN | rewrite HN']; auto.
  - eapply strays_first; [exact HS | exact HI | exact HO | exact HG | exact HL | |]; intros; [rewrite HN | rewrite HN']; auto.
Qed.

(** Steps that are not off. *)
Lemma strays_exact s l N sts gs M M' : holds_steps s l N -> strays s sts gs M M' ->
  strays s (l ++ sts) (map (fun _ => None) l ++ gs) (fun x => N (M x)) (fun x => N (M' x)).
Proof.
  intros H HM. induction H as [N HN | st l E L N HE HL IH HN]; cbn [app map].
  - eapply strays_same; [exact HM | intros; apply HN | intros; apply HN].
  - eapply strays_first with (E := E) (E' := E);
      [exact HE | intros x y; apply (step_keeps s st E x y HE) | exact (step_onto s st E HE) | intros x; reflexivity | exact IH | |]; intros; apply HN.
Qed.

Lemma element_strays s w q x e E E' sts gs M M' : Rabs s <= 1 -> holds_state x s q -> element_map w q e E E' -> strays s sts gs M M' ->
  strays s (steps_of x (selement_of e) ++ sts) (element_gives (off w) (Sstate [] (x_start x)) e ++ gs)
    (fun y => E (M y)) (fun y => E' (M' y)).
Proof.
  intros Hs [Hq Hst] HE HM.
  destruct HE as [a k v m c e AM He | a k v m c e u AM He Hu | v S D HS HD R]; cbn [selement_of steps_of element_gives].
  - assert (H : holds (tm_add (tm_mul (tm_number m) (nth v (x_amount x) tm_zero)) (tm_number c)) s (real m * amount q v + real c))
      by (apply holds_add; [apply holds_mul; [exact Hs | apply holds_number | apply Hq] | apply holds_number]).
    pose proof (sincos_holds s _ _ Hs H) as SC. destruct (sincos _) as [sn cs]. cbn [fst snd] in SC. destruct SC as [S C].
    cbn [app]. eapply strays_first; [| | | | exact HM | reflexivity | reflexivity].
    + apply holds_turned with (k := k) (sn := sin (real m * amount q v + real c)) (cs := cos (real m * amount q v + real c)); auto.
      * apply axis_ok. exact AM.
      * apply AM.
      * rewrite <- (sin2_cos2 (real m * amount q v + real c)). reflexivity.
    + apply turn_isometry. apply AM.
    + apply turn_onto. apply AM.
    + replace (real m * (amount q v + e) + real c) with ((real m * amount q v + real c) + real m * e) by ring.
      destruct (listed (of_variables (off w)) v) as [d|] eqn:L; cbn [moves_by].
      * exists k. cbn [g_axis g_at g_chord g_slide arm]. split; [apply axis_ok; exact AM|]. split; [intros _; apply AM|].
        split; [apply chord_of_nonneg, mulup_nonneg; [apply abs_up_nonneg | apply listed_up_nonneg]|]. intros y.
        rewrite V_0, Rplus_0_l. eapply Rle_trans.
        -- apply (turn_moves k _ (real m * e) (V (mulup (abs_up m) (listed_up (of_variables (off w)) v)))); [apply AM|].
           apply times_error. exact He.
        -- apply Rmult_le_compat_r; [apply norm_nonneg|]. apply chord_of_ok. lra.
      * rewrite (listed_none _ _ L) in He. rewrite (no_error _ He). intros y. rewrite Rmult_0_r, Rplus_0_r. reflexivity.
  - assert (H : holds (tm_add (tm_mul (tm_number m) (nth v (x_amount x) tm_zero)) (tm_number c)) s (real m * amount q v + real c))
      by (apply holds_add; [apply holds_mul; [exact Hs | apply holds_number | apply Hq] | apply holds_number]).
    cbn [app].
    eapply strays_first with (E := fun y => add y (scale (real m * amount q v + real c) k))
      (E' := fun y => add (add y (scale (real m * (amount q v + e) + real c) k)) u); [| | | | exact HM | reflexivity | reflexivity].
    + apply holds_slid with (k := k) (way := real m * amount q v + real c); auto. apply axis_ok. exact AM.
    + intros y z. f_equal. unfold sub, add, scale; cbn [vx vy vz]. f_equal; ring.
    + intros y. destruct (shifted_onto u y) as [z <-].
      destruct (shifted_onto (scale (real m * (amount q v + e) + real c) k) z) as [y0 <-]. exists y0. reflexivity.
    + assert (SUB : forall y, sub (add (add y (scale (real m * (amount q v + e) + real c) k)) u)
        (add y (scale (real m * amount q v + real c) k)) = add (scale (real m * e) k) u)
        by (intros y; unfold sub, add, scale; cbn [vx vy vz]; f_equal; ring).
      assert (G : moves_by s (Some (Give false origin_tm 0
        (mulup (abs_up m) (listed_up (of_variables (off w)) v + listed_up (of_vectors (off w)) v))))
        (fun y => add y (scale (real m * amount q v + real c) k))
        (fun y => add (add y (scale (real m * (amount q v + e) + real c) k)) u)).
      { exists (Vec 0 0 0). cbn [g_axis g_at g_chord g_slide]. split; [apply origin_holds|]. split; [discriminate|].
        rewrite V_0. split; [lra|]. intros y. rewrite Rmult_0_l, Rplus_0_r, SUB. eapply Rle_trans; [apply triangle|].
        assert (N : norm (scale (real m * e) k) = Rabs (real m * e)).
        { unfold norm. replace (dot (scale (real m * e) k) (scale (real m * e) k)) with (Rsqr (real m * e) * dot k k)
            by (unfold dot, scale, Rsqr; cbn [vx vy vz]; ring).
          rewrite (proj1 AM), Rmult_1_r. apply sqrt_Rsqr_abs. }
        rewrite N, Rabs_mult. eapply Rle_trans; [|apply mulup_ge]. rewrite V_add.
        pose proof (listed_up_ok (of_variables (off w)) v). pose proof (listed_up_ok (of_vectors (off w)) v).
        pose proof (abs_up_ok m) as Am. pose proof (Rabs_pos (real m)). pose proof (Rabs_pos e).
        set (dv := most (of_variables (off w)) v) in *. set (lv := most (of_vectors (off w)) v) in *.
        set (dV := V (listed_up (of_variables (off w)) v)) in *. set (lV := V (listed_up (of_vectors (off w)) v)) in *.
        assert (lV0 : 0 <= lV) by (apply V_nonneg, listed_up_nonneg).
        apply Rle_trans with (Rabs (real m) * (dV + lV)); [|apply Rmult_le_compat_r; lra].
        apply Rle_trans with (Rabs (real m) * dv + Rabs (real m) * lv);
          [apply Rplus_le_compat; [apply Rmult_le_compat_l; assumption | exact Hu]|].
        rewrite Rmult_plus_distr_l. apply Rplus_le_compat; apply Rmult_le_compat_l; assumption. }
      destruct (listed (of_variables (off w)) v) eqn:L1; [exact G|].
      destruct (listed (of_vectors (off w)) v) eqn:L2; [exact G|]. cbn [moves_by]. intros y.
      rewrite (listed_none _ _ L1) in He. rewrite (listed_none _ _ L2), Rmult_0_r in Hu.
      rewrite (no_error _ He), (no_norm _ Hu), Rplus_0_r. unfold add; cbn [vx vy vz]. f_equal; ring.
  - set (W := Vec (amount q v) (amount q (v + 1)) (amount q (v + 2))) in *.
    assert (HW : holds_step s (spin (Tvec (nth v (x_amount x) tm_zero) (nth (v + 1) (x_amount x) tm_zero) (nth (v + 2) (x_amount x) tm_zero))) (rotate W))
      by (apply spin_ok; [exact Hs | repeat split; apply Hq]).
    assert (IW : isometry (rotate W)).
    { intros y z. rewrite !rotate_is_spun.
      replace (sub (spun (scale (sin_part (norm W) 1) W) (cos_part (norm W) 1) y) (spun (scale (sin_part (norm W) 1) W) (cos_part (norm W) 1) z))
        with (spun (scale (sin_part (norm W) 1) W) (cos_part (norm W) 1) (sub y z)).
      - apply norm_of_dots, spun_keeps_dot. apply half_parts_square.
      - destruct y, z. unfold spun. coords. f_equal; ring. }
    cbn [app].
    eapply strays_first with (E := rotate W) (E' := fun y => D (rotate W y)) (M := fun y => S (M y)) (M' := fun y => S (M' y));
      [exact HW | | | | | reflexivity | reflexivity].
    + intros y z. rewrite (small_turn_isometry _ _ HD). apply IW.
    + intros y. destruct (small_turn_onto _ _ HD y) as [z <-]. destruct (step_onto _ _ _ HW z) as [y0 <-]. exists y0. reflexivity.
    + destruct (listed (of_rotations (off w)) v) as [d|] eqn:L; cbn [moves_by].
      * exists (Vec 0 0 0). cbn [g_axis g_at g_chord g_slide arm]. split; [apply origin_holds|]. split; [discriminate|].
        split; [apply chord_of_nonneg, listed_up_nonneg|]. intros y. rewrite V_0, Rplus_0_l.
        eapply Rle_trans; [apply (small_turn_moves _ _ _ HD)|]. apply Rmult_le_compat.
        -- destruct HD as (k' & a' & _ & A & _). pose proof (Rabs_pos a'). apply Rmin_glb; lra.
        -- apply norm_nonneg.
        -- apply chord_of_ok, listed_up_ok.
        -- apply Req_le. rewrite <- (IW y (Vec 0 0 0)). f_equal.
           assert (Z0 : rotate W (Vec 0 0 0) = Vec 0 0 0) by (unfold rotate; coords; f_equal; ring).
           rewrite Z0, sub_add_zero. reflexivity.
      * rewrite (listed_none _ _ L) in HD. destruct HD as (k' & a' & _ & A & ED). intros y.
        rewrite ED, (no_error _ A). apply turn_zero.
    + change (starts (Sstate [] (x_start x)) v) with (starts x v). apply strays_exact; [apply Hst; exact HS | exact HM].
Qed.

(** ** Where the points of a body are

    W p + o as models: the columns of W, and o. *)
Record pose := Pose { wx : tvec; wy : tvec; wz : tvec; wo : tvec }.

Definition affine (a b c d x : vec) : vec := add (add (scale (vx x) a) (scale (vy x) b)) (add (scale (vz x) c) d).

Definition holds_pose (s : R) (T : pose) (E : vec -> vec) : Prop :=
  exists a b c d, holdsv (wx T) s a /\ holdsv (wy T) s b /\ holdsv (wz T) s c /\ holdsv (wo T) s d /\
    forall x, E x = affine a b c d x.

(** Every column by f, the last one by g. *)
Definition each (f g : tvec -> tvec) (T : pose) : pose := Pose (f (wx T)) (f (wy T)) (f (wz T)) (g (wo T)).

(** After one more step. *)
Definition rise (st : step) (T : pose) : pose :=
  match st with
  | Turned k sn cs => each (tturned k sn cs) (tturned k sn cs) T
  | Slid k way => each (fun v => v) (fun v => tadd v (tscale way k)) T
  | Spun u c => each (tspun u c) (tspun u c) T
  | Placed a b c p =>
      let f v := Tvec (tdot a v) (tdot b v) (tdot c v) in each f (fun v => tadd (f v) p) T
  end.

(** Before the step: what it takes to T. *)
Definition sink (st : step) (T : pose) : pose :=
  match st with
  | Turned k sn cs => let f := tturned k (tm_opp sn) cs in each f f T
  | Slid k way => each (fun v => v) (fun v => tsub v (tscale way k)) T
  | Spun u c => let f := tspun (topp u) c in each f f T
  | Placed a b c p =>
      let f v := tadd (tadd (tscale (tx v) a) (tscale (ty v) b)) (tscale (tz v) c) in each f (fun v => f (tsub v p)) T
  end.

(** Less the point c; or the cross product with the axis c. *)
Definition arms (axis : bool) (c : tvec) (T : pose) : pose :=
  if axis then each (tcross c) (tcross c) T else each (fun v => v) (fun v => tsub v c) T.

Definition at_rest : pose :=
  Pose (Tvec tm_one tm_zero tm_zero) (Tvec tm_zero tm_one tm_zero) (Tvec tm_zero tm_zero tm_one) origin_tm.

Definition spot (T : pose) (x : tvec) : tvec :=
  tadd (tadd (tscale (tx x) (wx T)) (tscale (ty x) (wy T))) (tadd (tscale (tz x) (wz T)) (wo T)).

(** Above the length of a vector of models: with its Bernstein coefficients b_i, |sum B_i b_i| <= sum B_i |b_i|. *)
Definition integer_norm (x y z : Z) : Z := Z.sqrt_up (x * x + y * y + z * z).
Definition lengths (v : tvec) : upper :=
  let at_ pick := integer_norm (pick (tx v)) (pick (ty v)) (pick (tz v)) in
  let rest := (rem (tx v) + rem (ty v) + rem (tz v))%Z in
  Upper (at_ (fun m => c0 m - c1 m + c2 m)%Z + rest) (at_ (fun m => c0 m - c2 m)%Z + rest)
    (at_ (fun m => c0 m + c1 m + c2 m)%Z + rest).

(** How far the pieces are from the origin. *)
Definition longest (c : round) : Z :=
  match semiaxes c with Some a => Z.max (bound (tx a)) (Z.max (bound (ty a)) (bound (tz a))) | None => 0%Z end.
Definition corner_far (T : pose) (c : round) : upper := upper_add (lengths (spot T (centre c))) (upper_const (longest c)).
Fixpoint corners_far (T : pose) (cs : list round) : option upper :=
  match cs with
  | [] => None
  | [c] => Some (corner_far T c)
  | c :: rest => upper_join (Some (corner_far T c)) (corners_far T rest)
  end.
Definition far_one (T : pose) (o : outline) : option upper :=
  match o with
  | Outline corners radius => option_map (fun u => upper_add u (upper_const (Z.max 0 radius))) (corners_far T corners)
  | Wall _ _ _ => None
  end.

(** The middle of a box, and half its diagonal. *)
Definition box_middle (b : bounds) : vec :=
  Vec (V ((x0 b + x1 b) / 2)) (V ((y0 b + y1 b) / 2)) (V ((z0 b + z1 b) / 2)).
Definition tbox_middle (b : bounds) : tvec :=
  Tvec (const ((x0 b + x1 b) / 2) 0) (const ((y0 b + y1 b) / 2) 0) (const ((z0 b + z1 b) / 2) 0).
Definition box_radius (b : bounds) : Z :=
  let half lo hi := (let m := (lo + hi) / 2 in Z.max (hi - m) (m - lo))%Z in
  let x := half (x0 b) (x1 b) in let y := half (y0 b) (y1 b) in let z := half (z0 b) (z1 b) in
  Z.sqrt_up (x * x + y * y + z * z).
Definition box_far (T : pose) (b : bounds) : upper := upper_add (lengths (spot T (tbox_middle b))) (upper_const (box_radius b)).

(** The greater of [best] and how far the pieces are. Groups that are not beyond it are passed over; of a box that is small
    all of it is taken. *)
Fixpoint far_in (T : pose) (t : forest) (best : upper) : option upper :=
  match t with
  | Piece o => upper_join (Some best) (far_one T o)
  | Group _ b l r =>
      let deeper := match far_in T l best with Some u => far_in T r u | None => None end in
      match b with
      | Some x =>
          let q := box_far T x in
          if upper_leb q best then Some best
          else if Z.leb (256 * box_radius x) (u1 q) then Some (upper_max best q)
          else deeper
      | None => deeper
      end
  end.
Definition far (T : pose) (t : forest) : option upper := far_in T t (upper_const 0).

Definition upper_scale (c : Z) (u : upper) : upper := Upper (mulup c (u0 u)) (mulup c (u1 u)) (mulup c (u2 u)).
Definition upper_plus (a b : option upper) : option upper :=
  match a, b with Some u, Some w => Some (upper_add u w) | _, _ => None end.

(** How far the pieces stray where T has them. None: there is no bound. *)
Definition move (os : forest) (g : option give) (T : pose) : option upper :=
  match g with
  | None => Some (upper_const 0)
  | Some g =>
      if Z.leb (g_chord g) 0 then Some (upper_const (g_slide g))
      else option_map (fun u => upper_add (upper_const (g_slide g)) (upper_scale (g_chord g) u))
             (far (arms (g_axis g) (g_at g) T) os)
  end.

(** Through all steps of a frame, the last one first. *)
Fixpoint rise_all (os : forest) (sts : list step) (gs : list (option give)) (T : pose) : pose * option upper :=
  match sts, gs with
  | st :: sts', g :: gs' => let (T', u) := rise_all os sts' gs' T in (rise st T', upper_plus u (move os g T'))
  | _, _ => (T, Some (upper_const 0))
  end.

(** The other way: from the parent's coordinates down, the first step first. *)
Fixpoint fall_all (os : forest) (sts : list step) (gs : list (option give)) (T : pose) : pose * option upper :=
  match sts, gs with
  | st :: sts', g :: gs' =>
      let T' := sink st T in
      let (T'', u) := fall_all os sts' gs' T' in (T'', upper_plus (move os g T') u)
  | _, _ => (T, Some (upper_const 0))
  end.

(** Where the pieces are in frame i and in all above it, and how far they stray, seen from there. *)
Record view := View { v_frame : nat; v_pose : pose; v_stray : option upper }.
Fixpoint moves (fuel : nat) (fs : tree) (gs : list (list (option give))) (os : forest) (v : view) : list view :=
  v ::
  match fuel, v_frame v with
  | S n, S j =>
      match nth_error fs j, nth_error gs j with
      | Some (p, sts), Some g =>
          let (T, w) := rise_all os sts g (v_pose v) in moves n fs gs os (View p T (upper_plus (v_stray v) w))
      | _, _ => []
      end
  | _, _ => []
  end.

(** Seen from the frames of a list, of which each stands in the one before. *)
Fixpoint descend (fs : tree) (gs : list (list (option give))) (os : forest) (v : view) (l : list nat) : list view :=
  match l with
  | S j :: rest =>
      match nth_error fs j, nth_error gs j with
      | Some (p, sts), Some g =>
          if Nat.eqb p (v_frame v) then
            let (T, w) := fall_all os sts g (v_pose v) in
            let v' := View (S j) T (upper_plus (v_stray v) w) in v' :: descend fs gs os v' rest
          else []
      | _, _ => []
      end
  | _ => []
  end.

(** The same where nothing strays. *)
Fixpoint still_in (fuel : nat) (fs : tree) (i : nat) : list view :=
  View i at_rest (Some (upper_const 0)) ::
  match fuel, i with
  | S n, S j => match nth_error fs j with Some (p, _) => still_in n fs p | None => [] end
  | _, _ => []
  end.

Section AtOneTime.
Variable s : R.
Hypothesis Hs : Rabs s <= 1.

Lemma rise_ok st E T F : holds_step s st E -> holds_pose s T F -> holds_pose s (rise st T) (fun x => E (F x)).
Proof.
  intros HE (a & b & c & d & HA & HB & HC & HD & X).
  destruct HE as [km snm csm k sn cs E Hk Hsn Hcs K S HE | km wm k way E Hk Hw HE
                 | um cm u cc E Hu Hc K HE | p1 p2 p3 pm m p E H1 H2 H3 Hp R HE]; cbn [rise].
  - exists (turned k sn cs a), (turned k sn cs b), (turned k sn cs c), (turned k sn cs d).
    repeat (split; [apply holdsv_turned; assumption|]). intros x. rewrite HE, X.
    destruct k, a, b, c, d, x. unfold affine. coords. f_equal; ring.
  - exists a, b, c, (add d (scale way k)).
    repeat (split; [assumption|]). split; [apply holdsv_add; [exact HD | apply holdsv_scale; assumption]|].
    intros x. rewrite HE, X. unfold affine. coords. f_equal; ring.
  - exists (spun u cc a), (spun u cc b), (spun u cc c), (spun u cc d).
    repeat (split; [apply holdsv_spun; assumption|]). intros x. rewrite HE, X.
    destruct u, a, b, c, d, x. unfold affine, spun. coords. f_equal; ring.
  - assert (AP : forall vm v, holdsv vm s v -> holdsv (Tvec (tdot p1 vm) (tdot p2 vm) (tdot p3 vm)) s (apply m v))
      by (intros; repeat split; apply holds_dot; assumption).
    exists (apply m a), (apply m b), (apply m c), (add (apply m d) p).
    repeat (split; [apply AP; assumption|]). split; [apply holdsv_add; [apply AP; exact HD | exact Hp]|].
    intros x. rewrite HE, X. destruct m as [[] [] []], a, b, c, d, p, x. unfold affine, apply; cbn [row1 row2 row3]. coords.
    f_equal; ring.
Qed.

(** The step's inverse, and its models. *)
Lemma sink_ok st E T F : holds_step s st E -> holds_pose s T F ->
  exists I, (forall x, E (I x) = x) /\ holds_pose s (sink st T) (fun x => I (F x)).
Proof.
  intros HE (a & b & c & d & HA & HB & HC & HD & X).
  destruct HE as [km snm csm k sn cs E Hk Hsn Hcs K S HE | km wm k way E Hk Hw HE
                 | um cm u cc E Hu Hc K HE | p1 p2 p3 pm m p E H1 H2 H3 Hp R HE]; cbn [sink].
  - exists (turned k (- sn) cs). split.
    { intros x. rewrite HE. apply dot_determines. intros v.
      rewrite dot_turned, turned_keeps_dot; [reflexivity | exact K | rewrite <- S; ring]. }
    exists (turned k (- sn) cs a), (turned k (- sn) cs b), (turned k (- sn) cs c), (turned k (- sn) cs d).
    repeat (split; [apply holdsv_turned; try assumption; apply holds_opp; assumption|]). intros x. rewrite X.
    destruct k, a, b, c, d, x. unfold affine. coords. f_equal; ring.
  - exists (fun x => sub x (scale way k)). split.
    { intros x. rewrite HE. destruct x, k. coords. f_equal; ring. }
    exists a, b, c, (sub d (scale way k)).
    repeat (split; [assumption|]). split.
    + destruct HD as (D1 & D2 & D3), (holdsv_scale s Hs _ _ _ _ Hw Hk) as (K1 & K2 & K3).
      repeat split; unfold sub, add; cbn [each wo tsub tx ty tz vx vy vz];
        (eapply holds_eq; [|apply holds_sub; eassumption]); unfold scale; cbn [vx vy vz]; ring.
    + intros x. rewrite X. unfold affine. coords. f_equal; ring.
  - exists (spun (scale (-1) u) cc). split.
    { intros x. rewrite HE. apply dot_determines. intros v. rewrite dot_spun, spun_keeps_dot; [reflexivity|].
      rewrite <- K. unfold dot, scale; cbn [vx vy vz]. ring. }
    exists (spun (scale (-1) u) cc a), (spun (scale (-1) u) cc b), (spun (scale (-1) u) cc c), (spun (scale (-1) u) cc d).
    repeat (split; [apply holdsv_spun; try assumption; apply holdsv_opp; assumption|]). intros x. rewrite X.
    destruct u, a, b, c, d, x. unfold affine, spun. coords. f_equal; ring.
  - exists (fun x => apply (transpose m) (sub x p)). split.
    { intros x. rewrite HE. replace (apply m (apply (transpose m) (sub x p))) with (sub x p).
      - destruct x, p. coords. f_equal; ring.
      - apply dot_determines. intros v. rewrite dot_apply.
        rewrite (rotation_keeps_dot (transpose m)) by (apply transpose_is_rotation; exact R). reflexivity. }
    assert (AP : forall vm v, holdsv vm s v ->
      holdsv (tadd (tadd (tscale (tx vm) p1) (tscale (ty vm) p2)) (tscale (tz vm) p3)) s (apply (transpose m) v)).
    { intros vm v (V1 & V2 & V3). replace (apply (transpose m) v) with
        (add (add (scale (vx v) (row1 m)) (scale (vy v) (row2 m))) (scale (vz v) (row3 m))).
      - repeat apply holdsv_add; apply holdsv_scale; assumption.
      - destruct m as [[] [] []], v. unfold apply, transpose, column1, column2, column3; cbn [row1 row2 row3]. coords.
        f_equal; ring. }
    exists (apply (transpose m) a), (apply (transpose m) b), (apply (transpose m) c), (apply (transpose m) (sub d p)).
    repeat (split; [apply AP; assumption|]). split.
    + apply AP. destruct HD as (D1 & D2 & D3), Hp as (K1 & K2 & K3).
      repeat split; unfold sub, add, scale; cbn [tsub tx ty tz vx vy vz]; (eapply holds_eq; [|apply holds_sub; eassumption]; ring).
    + intros x. rewrite X. destruct m as [[] [] []], a, b, c, d, p, x.
      unfold affine, apply, transpose, column1, column2, column3; cbn [row1 row2 row3]. coords. f_equal; ring.
Qed.

Lemma at_rest_ok : holds_pose s at_rest (fun x => x).
Proof.
  exists (Vec 1 0 0), (Vec 0 1 0), (Vec 0 0 1), (Vec 0 0 0).
  repeat split; cbn [at_rest wx wy wz wo tx ty tz vx vy vz]; try apply holds_zero; try apply holds_one.
  intros x. destruct x. unfold affine. coords. f_equal; ring.
Qed.

Lemma arms_ok axis cm c T F : holdsv cm s c -> holds_pose s T F -> holds_pose s (arms axis cm T) (fun x => arm axis c (F x)).
Proof.
  intros Hc (p & q & r & o & HP & HQ & HR & HO & X). destruct axis; cbn [arms arm].
  - exists (cross c p), (cross c q), (cross c r), (cross c o).
    repeat (split; [apply holdsv_cross; assumption|]). intros x. rewrite X.
    destruct c, p, q, r, o, x. unfold affine. coords. f_equal; ring.
  - exists p, q, r, (sub o c). repeat (split; [assumption|]). split.
    + destruct HO as (A & B & C), Hc as (A' & B' & C').
      repeat split; unfold sub, add, scale; cbn [each wo tsub tx ty tz vx vy vz];
        (eapply holds_eq; [|apply holds_sub; eassumption]; ring).
    + intros x. rewrite X. unfold affine. coords. f_equal; ring.
Qed.

Lemma spot_ok T E xm x : holds_pose s T E -> holdsv xm s x -> holdsv (spot T xm) s (E x).
Proof.
  intros (a & b & c & d & HA & HB & HC & HD & X) (Hx & Hy & Hz). rewrite X. unfold spot, affine.
  repeat apply holdsv_add; try (apply holdsv_scale; assumption); assumption.
Qed.

Lemma lengths_ok m v : holdsv m s v -> below (lengths m) s (norm v).
Proof.
  intros (Hx & Hy & Hz). destruct (weights s Hs) as (W0 & W1 & W2).
  set (b pick := Vec (V (pick (tx m))) (V (pick (ty m))) (V (pick (tz m)))).
  set (p0 := fun m => (c0 m - c1 m + c2 m)%Z). set (p1 := fun m => (c0 m - c2 m)%Z). set (p2 := fun m => (c0 m + c1 m + c2 m)%Z).
  set (B0 := (1 - s) * (1 - s) / 4) in *. set (B1 := (1 - s) * (1 + s) / 2) in *. set (B2 := (1 + s) * (1 + s) / 4) in *.
  set (mean := add (add (scale B0 (b p0)) (scale B1 (b p1))) (scale B2 (b p2))).
  assert (SP : forall k u, 0 <= k -> norm (scale k u) = k * norm u).
  { intros k u Hk. unfold norm. replace (dot (scale k u) (scale k u)) with (k * k * dot u u) by (coords; ring).
    rewrite sqrt_mult_alt by (apply Rmult_le_pos; exact Hk). rewrite sqrt_square by exact Hk. reflexivity. }
  assert (NM : norm mean <= B0 * norm (b p0) + B1 * norm (b p1) + B2 * norm (b p2)).
  { rewrite <- !SP by assumption. unfold mean. eapply Rle_trans; [apply triangle|]. apply Rplus_le_compat_r, triangle. }
  assert (PM : forall a, V (p0 a) * B0 + V (p1 a) * B1 + V (p2 a) * B2 = poly a s).
  { intros a. unfold p0, p1, p2, poly, B0, B1, B2. rewrite !V_add, !V_sub. field. }
  set (rest := (rem (tx m) + rem (ty m) + rem (tz m))%Z).
  assert (R : norm (sub v mean) <= V rest).
  { eapply Rle_trans; [apply norm_sum|]. unfold rest. rewrite !V_add. unfold holds in Hx, Hy, Hz.
    rewrite <- PM in Hx, Hy, Hz. unfold mean, b, sub, add, scale; cbn [vx vy vz].
    repeat apply Rplus_le_compat;
      match goal with |- Rabs ?u <= _ => match goal with H : Rabs ?k <= V (rem _) |- _ => replace u with k by ring; exact H end end. }
  assert (N : norm v <= norm mean + norm (sub v mean)).
  { eapply Rle_trans; [|apply triangle]. apply Req_le. f_equal. destruct v as [p q r]. generalize mean. intros [p' q' r']. coords.
    f_equal; ring. }
  pose proof (integer_length (p0 (tx m)) (p0 (ty m)) (p0 (tz m))) as L0.
  pose proof (integer_length (p1 (tx m)) (p1 (ty m)) (p1 (tz m))) as L1.
  pose proof (integer_length (p2 (tx m)) (p2 (ty m)) (p2 (tz m))) as L2.
  change (norm (b p0) <= V (integer_norm (c0 (tx m) - c1 (tx m) + c2 (tx m)) (c0 (ty m) - c1 (ty m) + c2 (ty m))
    (c0 (tz m) - c1 (tz m) + c2 (tz m)))) in L0.
  change (norm (b p1) <= V (integer_norm (c0 (tx m) - c2 (tx m)) (c0 (ty m) - c2 (ty m)) (c0 (tz m) - c2 (tz m)))) in L1.
  change (norm (b p2) <= V (integer_norm (c0 (tx m) + c1 (tx m) + c2 (tx m)) (c0 (ty m) + c1 (ty m) + c2 (ty m))
    (c0 (tz m) + c1 (tz m) + c2 (tz m)))) in L2.
  unfold below, lengths; cbn [u0 u1 u2]. fold rest. rewrite !(V_add _ rest). fold B0 B1 B2.
  apply (Rmult_le_compat_r B0) in L0; [|exact W0]. apply (Rmult_le_compat_r B1) in L1; [|exact W1].
  apply (Rmult_le_compat_r B2) in L2; [|exact W2].
  assert (ONE : B0 + B1 + B2 = 1) by (unfold B0, B1, B2; field).
  replace (V rest) with (V rest * (B0 + B1 + B2)) in R by (rewrite ONE; ring).
  rewrite !Rmult_plus_distr_r. lra.
Qed.

Definition short (E : vec -> vec) : Prop := forall x y, norm (sub (E x) (E y)) <= norm (sub x y).

Lemma arm_short axis c F : (axis = true -> dot c c = 1) -> isometry F -> short (fun x => arm axis c (F x)).
Proof.
  intros C I x y. rewrite <- (I x y). destruct axis; cbn [arm].
  - replace (sub (cross c (F x)) (cross c (F y))) with (cross c (sub (F x) (F y))).
    + apply cross_short. apply C. reflexivity.
    + generalize (F x) (F y). intros [] []. destruct c. coords. f_equal; ring.
  - apply Req_le. f_equal. coords. f_equal; ring.
Qed.

Lemma times_short m a v : holdsv m s a -> norm (times a v) <= V (Z.max (bound (tx m)) (Z.max (bound (ty m)) (bound (tz m)))) * norm v.
Proof.
  intros (A & B & C). apply (bound_ge _ s _ Hs) in A, B, C. set (r := Z.max _ _).
  assert (R1 : V (bound (tx m)) <= V r) by (apply V_le; unfold r; lia).
  assert (R2 : V (bound (ty m)) <= V r) by (apply V_le; unfold r; lia).
  assert (R3 : V (bound (tz m)) <= V r) by (apply V_le; unfold r; lia).
  assert (R0 : 0 <= V r) by (pose proof (Rabs_pos (vx a)); lra).
  assert (Q : forall x y, Rabs x <= V r -> x * y * (x * y) <= V r * V r * (y * y)).
  { intros x y H. apply abs_in in H. assert (x * x <= V r * V r) by nra. nra. }
  apply norm_le_of_squares; [apply Rmult_le_pos; [exact R0 | apply norm_nonneg]|].
  replace (V r * norm v * (V r * norm v)) with (V r * V r * dot v v) by (rewrite <- norm_square; ring).
  unfold dot, times; cbn [vx vy vz].
  pose proof (Q (vx a) (vx v) ltac:(lra)). pose proof (Q (vy a) (vy v) ltac:(lra)). pose proof (Q (vz a) (vz v) ltac:(lra)). lra.
Qed.

Lemma corners_far_ok T E cs c p a : holds_pose s T E -> In c cs -> holds_round c s p a ->
  below_opt (corners_far T cs) s (norm (E p) + V (longest c)).
Proof.
  intros HT I [Hp _]. assert (K : below (corner_far T c) s (norm (E p) + V (longest c))).
  { apply below_add; [apply lengths_ok, spot_ok; assumption | apply below_const; lra]. }
  induction cs as [|c' cs IH]; [destruct I|]. cbn [corners_far]. destruct cs as [|c'' cs].
  - destruct I as [->|[]]. exact K.
  - destruct I as [->|I]; [apply below_join_l; [exact Hs | exact K] | apply below_join_r; [exact Hs | apply IH; exact I]].
Qed.

(** A piece is no farther than one of its corners, and the corner's size: with y = E x = A x + d and v = A^T y, |v| <= |y|, so
    y.y = v.x + y.d is at most v.p + y.d + size |v| = y.E p + size |v|, at most |y| (|E p| + size). *)
Lemma far_one_ok T E o x : holds_pose s T E -> short E -> covers s o x -> below_opt (far_one T o) s (norm (E x)).
Proof.
  intros HT SH C. destruct o as [corners radius|]; [|exact I]. unfold far_one. cbn [covers] in C.
  pose proof HT as (a & b & c & d & _ & _ & _ & _ & X).
  set (y := E x). set (v := Vec (dot a y) (dot b y) (dot c y)).
  assert (L : forall z, dot v z + dot y d = dot y (E z)).
  { intros z. rewrite X. unfold affine, v, dot, add, scale; cbn [vx vy vz]. ring. }
  assert (NV : norm v <= norm y).
  { pose proof (norm_nonneg v). pose proof (norm_nonneg y).
    assert (Q : norm v * norm v <= norm y * norm v).
    { rewrite norm_square. replace (dot v v) with (dot y (sub (E v) (E (Vec 0 0 0)))).
      - eapply Rle_trans; [apply cauchy|]. apply Rmult_le_compat_l; [apply norm_nonneg|].
        eapply Rle_trans; [apply SH|]. rewrite sub_add_zero. lra.
      - replace (dot y (sub (E v) (E (Vec 0 0 0)))) with (dot y (E v) - dot y (E (Vec 0 0 0)))
          by (unfold dot, sub, add, scale; cbn [vx vy vz]; ring).
        rewrite <- !L. unfold dot at 3; cbn [vx vy vz]. ring. }
    destruct (Req_dec (norm v) 0) as [Z0|N]; nra. }
  destruct (C v) as (k & p & ax & Ik & Hk & B).
  pose proof (corners_far_ok T E corners k p ax HT Ik Hk) as F.
  destruct (corners_far T corners) as [u|]; [|exact I]. cbn [option_map below_opt] in *.
  apply below_weaken with ((norm (E p) + V (longest k)) + V (Z.max 0 radius)); [|apply below_add; [exact F | apply below_const; lra]].
  destruct (V_max 0 radius) as [M0 M1]. rewrite V_0 in M0.
  assert (LG : norm (times ax v) <= V (longest k) * norm v /\ 0 <= V (longest k)).
  { destruct Hk as [_ Hx]. unfold longest. destruct (semiaxes k) as [m|].
    - split; [apply times_short; exact Hx|]. destruct Hx as (A & _). apply (bound_ge _ s _ Hs) in A.
      apply Rle_trans with (V (bound (tx m))); [pose proof (Rabs_pos (vx ax)); lra | apply V_le; lia].
    - subst ax. rewrite norm_nil, V_0. split; lra. }
  destruct LG as [LG L0]. pose proof (norm_nonneg y) as Y0. pose proof (norm_nonneg (E p)) as P0. pose proof (norm_nonneg v).
  destruct (Req_dec (norm y) 0) as [->|NY]; [lra|].
  apply Rmult_le_reg_l with (norm y); [lra|].
  rewrite norm_square. unfold y at 2. rewrite <- (L x).
  assert (CP : dot v p + dot y d <= norm y * norm (E p)) by (rewrite L; apply cauchy).
  assert (V (longest k) * norm v <= V (longest k) * norm y) by (apply Rmult_le_compat_l; assumption).
  assert (V radius * norm v <= V (Z.max 0 radius) * norm y).
  { apply Rle_trans with (V (Z.max 0 radius) * norm v); [apply Rmult_le_compat_r; assumption | apply Rmult_le_compat_l; assumption]. }
  lra.
Qed.

Lemma box_radius_ok b x : in_bounds b x -> norm (sub x (box_middle b)) <= V (box_radius b).
Proof.
  intros (B1 & B2 & B3). unfold box_radius. eapply Rle_trans; [|apply integer_length].
  assert (K : forall lo hi y, V lo <= y <= V hi -> Rabs (y - V ((lo + hi) / 2)) <= V (Z.max (hi - (lo + hi) / 2) ((lo + hi) / 2 - lo))).
  { intros lo hi y H. set (m := ((lo + hi) / 2)%Z). destruct (V_max (hi - m) (m - lo)) as [M1 M2].
    rewrite V_sub in M1, M2. apply Rabs_le. lra. }
  apply K in B1, B2, B3. apply sqrt_le_1_alt. unfold dot, sub, add, scale, box_middle; cbn [vx vy vz].
  assert (S : forall y c r, Rabs (y - c) <= r -> (y + -1 * c) * (y + -1 * c) <= r * r).
  { intros y c r H. apply abs_in in H. nra. }
  repeat apply Rplus_le_compat; apply S; assumption.
Qed.

Lemma box_far_ok T E b x : holds_pose s T E -> short E -> in_bounds b x -> below (box_far T b) s (norm (E x)).
Proof.
  intros HT SH B. apply below_weaken with (norm (E (box_middle b)) + V (box_radius b)).
  - replace (E x) with (add (E (box_middle b)) (sub (E x) (E (box_middle b)))).
    + eapply Rle_trans; [apply triangle|]. pose proof (SH x (box_middle b)). pose proof (box_radius_ok b x B). lra.
    + generalize (E x) (E (box_middle b)). intros [] []. coords. f_equal; ring.
  - apply below_add; [|apply below_const; lra]. apply lengths_ok, spot_ok; [exact HT|].
    repeat split; apply holds_exact.
Qed.

Lemma far_in_ok T E t : holds_pose s T E -> short E -> forall best u, far_in T t best = Some u ->
  (forall y, below best s y -> below u s y) /\ forall o x, has t o -> covers s o x -> below u s (norm (E x)).
Proof.
  intros HT SH. induction t as [o | n b t1 IH1 t2 IH2]; intros best u; cbn [far_in has].
  - destruct (far_one T o) as [w|] eqn:F; [|discriminate]. cbn [upper_join]. intros [= <-]. split.
    + intros y. apply below_mono; [exact Hs | apply upper_max_l].
    + intros o' x -> C. pose proof (far_one_ok T E o' x HT SH C) as K. rewrite F in K. cbn [below_opt] in K.
      eapply below_mono; [exact Hs | apply upper_max_r | exact K].
  - assert (D : match far_in T t1 best with Some u => far_in T t2 u | None => None end = Some u ->
      (forall y, below best s y -> below u s y) /\
      forall o x, (has t1 o \/ has t2 o) -> covers s o x -> below u s (norm (E x))).
    { destruct (far_in T t1 best) as [w|] eqn:E1; [|discriminate]. intros E2.
      destruct (IH1 _ _ E1) as [M1 K1]. destruct (IH2 _ _ E2) as [M2 K2]. split; [auto|].
      intros o x [H|H] C; [apply M2; exact (K1 o x H C) | exact (K2 o x H C)]. }
    destruct b as [b|].
    + destruct (upper_leb (box_far T b) best) eqn:P; [|destruct (Z.leb (256 * box_radius b) (u1 (box_far T b)))].
      * intros [= <-]. split; [auto|]. intros o x [_ B] C.
        eapply below_mono; [exact Hs | apply upper_leb_ok; exact P | apply box_far_ok; [exact HT | exact SH | exact (B s x C)]].
      * intros [= <-]. split.
        -- intros y. apply below_mono; [exact Hs | apply upper_max_l].
        -- intros o x [_ B] C. eapply below_mono; [exact Hs | apply upper_max_r|].
           apply box_far_ok; [exact HT | exact SH | exact (B s x C)].
      * intros H. destruct (D H) as [M K]. split; [exact M|]. intros o x [I _] C. exact (K o x I C).
    + intros H. destruct (D H) as [M K]. split; [exact M|]. intros o x [I _] C. exact (K o x I C).
Qed.

Lemma below_scale c u y : 0 <= V c -> below u s y -> below (upper_scale c u) s (V c * y).
Proof.
  intros C H. destruct (weights s Hs) as (W0 & W1 & W2). unfold below, upper_scale in *; cbn [u0 u1 u2].
  apply Rle_trans with (V c * (V (u0 u) * ((1 - s) * (1 - s) / 4) + V (u1 u) * ((1 - s) * (1 + s) / 2) + V (u2 u) * ((1 + s) * (1 + s) / 4))).
  - apply Rmult_le_compat_l; assumption.
  - pose proof (mulup_ge c (u0 u)). pose proof (mulup_ge c (u1 u)). pose proof (mulup_ge c (u2 u)).
    set (a := (1 - s) * (1 - s) / 4) in *. set (b := (1 - s) * (1 + s) / 2) in *. set (d := (1 + s) * (1 + s) / 4) in *.
    assert (V c * V (u0 u) * a <= V (mulup c (u0 u)) * a) by (apply Rmult_le_compat_r; assumption).
    assert (V c * V (u1 u) * b <= V (mulup c (u1 u)) * b) by (apply Rmult_le_compat_r; assumption).
    assert (V c * V (u2 u) * d <= V (mulup c (u2 u)) * d) by (apply Rmult_le_compat_r; assumption). lra.
Qed.

Lemma below_plus a b x y : below_opt a s x -> below_opt b s y -> below_opt (upper_plus a b) s (x + y).
Proof. destruct a, b; cbn [below_opt upper_plus]; try tauto. apply below_add. Qed.
Lemma below_opt_weaken u x y : x <= y -> below_opt u s y -> below_opt u s x.
Proof. destruct u; cbn [below_opt]; [apply below_weaken | tauto]. Qed.

Lemma move_ok os g T E E' F o x : moves_by s g E E' -> holds_pose s T F -> isometry F -> has os o -> covers s o x ->
  below_opt (move os g T) s (norm (sub (E' (F x)) (E (F x)))).
Proof.
  intros M HT IF I C. destruct g as [g|]; cbn [moves_by move] in *.
  - destruct M as (c & Hc & C1 & C0 & M). specialize (M (F x)).
    destruct (Z.leb_spec (g_chord g) 0) as [L|_]; cbn [below_opt].
    + apply below_const. eapply Rle_trans; [exact M|]. apply V_le in L. rewrite V_0 in L.
      replace (V (g_chord g)) with 0 by lra. lra.
    + unfold far. destruct (far_in _ os _) as [u|] eqn:K; cbn [option_map below_opt]; [|exact Logic.I].
      eapply below_weaken; [exact M|]. apply below_add; [apply below_const; lra|]. apply below_scale; [exact C0|].
      destruct (far_in_ok _ _ os (arms_ok (g_axis g) _ c T F Hc HT) (arm_short _ c F C1 IF) _ _ K) as [_ B].
      exact (B o x I C).
  - cbn [below_opt]. apply below_const. rewrite V_0, M. apply Req_le. rewrite <- norm_zero. f_equal. coords. f_equal; ring.
Qed.

(** X and X' are where the motion has a point and where it may be, seen from one frame. *)
Definition off_by (u : option upper) (X X' : vec) : Prop := below_opt u s (norm (sub X' X)).

Lemma triangle_of a b c : norm (sub a c) <= norm (sub a b) + norm (sub b c).
Proof.
  replace (sub a c) with (add (sub a b) (sub b c)); [apply triangle|]. destruct a, b, c. coords. f_equal; ring.
Qed.

Lemma rise_all_ok os sts gs E E' : strays s sts gs E E' -> forall T F o x X' u, holds_pose s T F -> isometry F ->
  has os o -> covers s o x -> off_by u (F x) X' ->
  let (T', w) := rise_all os sts gs T in
  holds_pose s T' (fun y => E (F y)) /\ isometry (fun y => E (F y)) /\ off_by (upper_plus u w) (E (F x)) (E' X').
Proof.
  unfold off_by. induction 1 as [gs E E' HE HE' | st sts g gs E E' M M' N N' HS IE OE HG HM IH HN HN'];
    intros T F o x X' u HT IF I C H.
  - replace (rise_all os [] gs T) with (T, Some (upper_const 0)) by (destruct gs; reflexivity). split; [|split].
    + destruct HT as (a & b & c & d & HA & HB & HC & HD & X). exists a, b, c, d.
      repeat (split; [assumption|]). intros y. rewrite HE. apply X.
    + intros y z. rewrite !HE. apply IF.
    + rewrite HE, HE', <- (Rplus_0_r (norm _)). apply below_plus; [exact H | apply below_const; rewrite V_0; lra].
  - cbn [rise_all]. specialize (IH T F o x X' u HT IF I C H).
    destruct (rise_all os sts gs T) as [T1 w]. destruct IH as (HT1 & I1 & B1). split; [|split].
    + destruct (rise_ok st E T1 _ HS HT1) as (a & b & c & d & HA & HB & HC & HD & X). exists a, b, c, d.
      repeat (split; [assumption|]). intros y. rewrite HN. apply X.
    + intros y z. rewrite !HN, (step_keeps s st E _ _ HS). apply I1.
    + pose proof (move_ok os g T1 E E' _ o x HG HT1 I1 I C) as B2. cbv beta in B2. rewrite HN, HN'.
      eapply below_opt_weaken; [apply triangle_of|].
      assert (A : forall a b c, below_opt (upper_plus (upper_plus a b) c) s = below_opt (upper_plus a (upper_plus b c)) s).
      { intros [a|] [b|] [c|]; cbn [upper_plus]; try reflexivity. unfold upper_add; cbn [u0 u1 u2]. rewrite !Z.add_assoc. reflexivity. }
      rewrite <- A. apply below_plus; [|exact B2]. rewrite (IE _ _). exact B1.
Qed.

(** X' is where E' takes it from: E' keeps distances, so what comes before the step is off by no more. *)
Lemma fall_all_ok os sts gs E E' : strays s sts gs E E' -> forall T F o x X' u, holds_pose s T F -> isometry F ->
  has os o -> covers s o x -> off_by u (F x) X' ->
  let (T', w) := fall_all os sts gs T in
  exists Y Z', holds_pose s T' Y /\ isometry Y /\ E (Y x) = F x /\ E' Z' = X' /\ off_by (upper_plus u w) (Y x) Z'.
Proof.
  unfold off_by. induction 1 as [gs E E' HE HE' | st sts g gs E E' M M' N N' HS IE OE HG HM IH HN HN'];
    intros T F o x X' u HT IF I C H.
  - replace (fall_all os [] gs T) with (T, Some (upper_const 0)) by (destruct gs; reflexivity).
    exists F, X'. split; [exact HT|]. split; [exact IF|]. split; [apply HE|]. split; [apply HE'|].
    rewrite <- (Rplus_0_r (norm _)). apply below_plus; [exact H | apply below_const; rewrite V_0; lra].
  - cbn [fall_all]. destruct (sink_ok st E T F HS HT) as (J & EJ & HT1). destruct (OE X') as [Z1 EZ].
    assert (IJ : isometry (fun y => J (F y))).
    { intros y z. rewrite <- (step_keeps s st E _ _ HS), !EJ. apply IF. }
    pose proof (move_ok os g (sink st T) E E' _ o x HG HT1 IJ I C) as B2. cbv beta in B2.
    assert (H1 : below_opt (upper_plus u (move os g (sink st T))) s (norm (sub Z1 (J (F x))))).
    { eapply below_opt_weaken; [|apply below_plus; [exact H | exact B2]]. rewrite <- (IE _ _), EZ.
      eapply Rle_trans; [apply (triangle_of _ (F x))|]. apply Rplus_le_compat_l. rewrite <- (EJ (F x)) at 1.
      apply Req_le. apply norm_of_dots. coords. ring. }
    specialize (IH (sink st T) (fun y => J (F y)) o x Z1 (upper_plus u (move os g (sink st T))) HT1 IJ I C H1).
    destruct (fall_all os sts gs (sink st T)) as [T2 w]. destruct IH as (Y & Z' & HT2 & IY & EY & EZ' & B). exists Y, Z'.
    split; [exact HT2|]. split; [exact IY|]. split; [rewrite HN, EY; apply EJ|]. split; [rewrite HN', EZ'; exact EZ|].
    assert (A : forall a b c, below_opt (upper_plus (upper_plus a b) c) s = below_opt (upper_plus a (upper_plus b c)) s).
    { intros [a|] [b|] [c|]; cbn [upper_plus]; try reflexivity. unfold upper_add; cbn [u0 u1 u2]. rewrite !Z.add_assoc. reflexivity. }
    rewrite <- A. exact B.
Qed.

Variable fs : tree.
Variable gs : list (list (option give)).
Variables P P' : nat -> vec -> vec.
Hypothesis child : forall i p sts g, nth_error fs i = Some (p, sts) -> nth_error gs i = Some g ->
  exists E E', strays s sts g E E' /\ (forall x, P (S i) x = P p (E x)) /\ (forall x, P' (S i) x = P' p (E' x)).

(** The point that is at X in the world on the motion, and may be at X' instead, seen from frame c. *)
Definition seen_from (c : nat) (u : option upper) (X X' : vec) : Prop :=
  exists z z', X = P c z /\ X' = P' c z' /\ off_by u z z'.
Definition seen (v : view) (x X X' : vec) : Prop :=
  exists F z', holds_pose s (v_pose v) F /\ isometry F /\ X = P (v_frame v) (F x) /\ X' = P' (v_frame v) z' /\
    off_by (v_stray v) (F x) z'.

Lemma seen_is_from v x X X' : seen v x X X' -> seen_from (v_frame v) (v_stray v) X X'.
Proof. intros (F & z' & _ & _ & E & E' & B). exists (F x), z'. auto. Qed.

Lemma moves_ok fuel os o x X X' : has os o -> covers s o x -> forall v, seen v x X X' ->
  forall v', In v' (moves fuel fs gs os v) -> seen v' x X X'.
Proof.
  intros I C. induction fuel as [|n IH]; intros v H v'; cbn [moves In]; (intros [<-|J]; [exact H|]); [destruct J|].
  destruct v as [[|j] T u]; cbn [v_frame v_pose v_stray] in *; [destruct J|].
  destruct (nth_error fs j) as [[p sts]|] eqn:N; [|destruct J]. destruct (nth_error gs j) as [g|] eqn:G; [|destruct J].
  destruct (child j p sts g N G) as (E & E' & HS & X1 & X2).
  destruct H as (F & z' & HT & IF & EX & EX' & B). cbn [v_frame v_pose v_stray] in *.
  pose proof (rise_all_ok os sts g E E' HS T F o x z' u HT IF I C B) as K.
  destruct (rise_all os sts g T) as [T1 w]. destruct K as (HT1 & I1 & B1).
  apply (IH (View p T1 (upper_plus u w))); [|exact J].
  exists (fun y => E (F y)), (E' z'). cbn [v_frame v_pose v_stray]. rewrite EX, EX', X1, X2. auto.
Qed.

Lemma descend_ok os o x X X' : has os o -> covers s o x -> forall l v, seen v x X X' ->
  forall v', In v' (descend fs gs os v l) -> seen v' x X X'.
Proof.
  intros I C. induction l as [|[|j] rest IH]; intros v H v'; cbn [descend]; try (intros []).
  destruct (nth_error fs j) as [[p sts]|] eqn:N; [|intros []]. destruct (nth_error gs j) as [g|] eqn:G; [|intros []].
  destruct (Nat.eqb_spec p (v_frame v)) as [->|_]; [|intros []].
  destruct (child j _ sts g N G) as (E & E' & HS & X1 & X2).
  destruct H as (F & z' & HT & IF & EX & EX' & B).
  pose proof (fall_all_ok os sts g E E' HS (v_pose v) F o x z' (v_stray v) HT IF I C B) as K.
  destruct (fall_all os sts g (v_pose v)) as [T1 w]. destruct K as (Y & Z' & HT1 & IY & EY & EZ & B1).
  assert (SEEN : seen (View (S j) T1 (upper_plus (v_stray v) w)) x X X').
  { exists Y, Z'. cbn [v_frame v_pose v_stray]. rewrite X1, X2, EY, EZ. auto. }
  intros [<-|J]; [exact SEEN | exact (IH _ SEEN v' J)].
Qed.
End AtOneTime.

(** ** The frames of a world *)

Definition is_none {T} (x : option T) : bool := match x with None => true | Some _ => false end.

(** What frames give over a piece of the motion; whether any frame or body gives something. *)
Record plays := Plays { p_gives : list (list (option give)); p_any : bool }.
Definition plays_of (w : world) (p : spiece) : plays :=
  let gs := gives_of w p in
  Plays gs (negb (forallb (forallb is_none) gs && forallb (fun b => is_none (body_give w b)) (bodies w))).

Lemma strays_none s sts gs E E' : strays s sts gs E E' -> forallb is_none gs = true -> forall x, E' x = E x.
Proof.
  induction 1 as [gs E E' HE HE' | st sts g gs E E' M M' N N' HS IE OE HG HM IH HN HN']; intros K x.
  - rewrite HE, HE'. reflexivity.
  - cbn [forallb] in K. apply andb_true_iff in K. destruct K as [K1 K2]. destruct g; [discriminate|]. cbn [moves_by] in HG.
    rewrite HN, HN', HG, (IH K2). reflexivity.
Qed.

Lemma strays_isometries s sts gs E E' : strays s sts gs E E' -> isometry E /\ isometry E'.
Proof.
  induction 1 as [gs E E' HE HE' | st sts g gs E E' M M' N N' HS IE OE HG HM [IM IM'] HN HN'].
  - split; intros x y; [rewrite !HE | rewrite !HE']; reflexivity.
  - split; intros x y; [rewrite !HN, (step_keeps s st E _ _ HS); apply IM | rewrite !HN', (IE _ _); apply IM'].
Qed.

Lemma elements_stray s w q x es M M' : Rabs s <= 1 -> holds_state x s q -> elements_map w q es M M' ->
  strays s (flat_map (steps_of x) (map selement_of es)) (flat_map (element_gives (off w) (Sstate [] (x_start x))) es) M M'.
Proof.
  intros Hs HX H. induction H as [|e es E E' M M' HE HM IH]; cbn [map flat_map].
  - apply strays_no; reflexivity.
  - eapply element_strays; eassumption.
Qed.

Lemma all_gives_nth w x fs : forall n i g, nth_error (all_gives w x n fs) i = Some g ->
  exists f, nth_error fs i = Some f /\ g = frame_gives w x (n + i) f.
Proof.
  induction fs as [|f fs IH]; intros n [|i] g; cbn [all_gives nth_error]; try discriminate.
  - intros [= <-]. exists f. rewrite Nat.add_0_r. auto.
  - intros H. destruct (IH _ _ _ H) as (f' & N & ->). exists f'. rewrite Nat.add_succ_r. auto.
Qed.

Lemma all_gives_length w x fs : forall n, length (all_gives w x n fs) = length fs.
Proof. induction fs as [|f fs IH]; intros n; [reflexivity|]. cbn [all_gives length]. rewrite IH. reflexivity. Qed.

Section Frames.
Variable w : world.
Variable pc : piece.
Variable s t : R.
Variable tmodel : tm.
Hypothesis Hs : Rabs s <= 1.
Hypothesis Ht : holds tmodel s t.
Variables P P' : nat -> vec -> vec.
Hypothesis HP : frames_at w (at_time pc t) P P'.
Hypothesis WF : forall i f, nth_error (frames w) i = Some f -> (parent f <= i)%nat.
Let fs := tree_of (map sframe_of (frames w)) (state_at (spiece_of pc) tmodel).
Let pl := plays_of w (spiece_of pc).

Lemma frame_strays i k sts g : nth_error fs i = Some (k, sts) -> nth_error (p_gives pl) i = Some g ->
  exists E E', strays s sts g E E' /\ (forall x, P (S i) x = P k (E x)) /\ (forall x, P' (S i) x = P' k (E' x)).
Proof.
  destruct HP as (_ & _ & F). unfold fs, tree_of. rewrite map_map, nth_error_map. intros N G.
  destruct (all_gives_nth _ _ _ _ _ _ G) as (f & Nf & ->). rewrite Nf in N. cbn in N. injection N as <- <-.
  destruct (F i f Nf) as (O & G0 & M & M' & HO & HG & HM & X & X').
  exists (fun x => O (M x)), (fun x => O (G0 (M' x))). split; [|auto]. unfold frame_gives. rewrite Nat.add_0_l.
  assert (IO : isometry O) by (intros x y; apply (step_keeps s _ _ x y (placed_ok s _ _ HO))).
  apply strays_first with (E := O) (E' := fun x => O (G0 x)) (M := M) (M' := M').
  - apply placed_ok. exact HO.
  - intros x y. rewrite (IO _ _). apply (pose_off_isometry _ _ HG).
  - intros y. destruct (step_onto s _ _ (placed_ok s _ _ HO) y) as [z <-]. destruct (pose_off_onto _ _ HG z) as [x <-].
    exists x. reflexivity.
  - apply pose_off_moves; assumption.
  - apply (elements_stray s w (at_time pc t) (state_at (spiece_of pc) tmodel) _ _ _ Hs); [apply state_ok; assumption | exact HM].
  - reflexivity.
  - reflexivity.
Qed.

Lemma fs_gs_length : length fs = length (frames w) /\ length (p_gives pl) = length (frames w).
Proof.
  split; [unfold fs, tree_of; rewrite !map_length; reflexivity | apply all_gives_length].
Qed.

Lemma both_there i : (i < length (frames w))%nat ->
  exists k sts g, nth_error fs i = Some (k, sts) /\ nth_error (p_gives pl) i = Some g /\ (k <= i)%nat.
Proof.
  intros L. destruct fs_gs_length as [L1 L2].
  destruct (nth_error fs i) as [[k sts]|] eqn:N; [|apply nth_error_None in N; lia].
  destruct (nth_error (p_gives pl) i) as [g|] eqn:G; [|apply nth_error_None in G; lia].
  exists k, sts, g. split; [reflexivity|]. split; [reflexivity|].
  unfold fs, tree_of in N. rewrite map_map, nth_error_map in N. destruct (nth_error (frames w) i) as [f|] eqn:Nf; [|discriminate].
  cbn in N. injection N as <- _. apply WF. exact Nf.
Qed.

Lemma frames_isometric n : forall i, (i <= n)%nat -> (i <= length (frames w))%nat -> isometry (P i) /\ isometry (P' i).
Proof.
  destruct HP as (P0 & P0' & _). induction n as [|n IH]; intros [|i] L1 L2.
  - split; intros x y; [rewrite !P0 | rewrite !P0']; reflexivity.
  - lia.
  - split; intros x y; [rewrite !P0 | rewrite !P0']; reflexivity.
  - destruct (both_there i ltac:(lia)) as (k & sts & g & N & G & K).
    destruct (frame_strays i k sts g N G) as (E & E' & HS & X & X'). destruct (strays_isometries _ _ _ _ _ HS) as [IE IE'].
    destruct (IH k ltac:(lia) ltac:(lia)) as [I I'].
    split; intros x y; [rewrite !X, (I _ _); apply IE | rewrite !X', (I' _ _); apply IE'].
Qed.

Lemma still_in_ok : p_any pl = false -> forall fuel i x v, In v (still_in fuel fs i) ->
  seen_from s P P' (v_frame v) (v_stray v) (P i x) (P' i x).
Proof.
  intros A. assert (Z0 : forall x : vec, off_by s (Some (upper_const 0)) x x).
  { intros x. unfold off_by, below_opt. apply below_const. rewrite V_0. apply Req_le. rewrite <- norm_zero. f_equal. coords. f_equal; ring. }
  induction fuel as [|n IH]; intros i x v; cbn [still_in In]; (intros [<-|J]; [exists x, x; auto|]); [destruct J|].
  destruct i as [|j]; [destruct J|]. destruct (nth_error fs j) as [[k sts]|] eqn:N; [|destruct J].
  assert (L : (j < length (frames w))%nat) by (rewrite <- (proj1 fs_gs_length); apply nth_error_Some; congruence).
  destruct (nth_error (p_gives pl) j) as [g|] eqn:G; [|apply nth_error_None in G; pose proof (proj2 fs_gs_length); lia].
  destruct (frame_strays j k sts g N G) as (E & E' & HS & X1 & X2).
  assert (K : forallb is_none g = true).
  { unfold pl, plays_of in A. cbn [p_any] in A. apply negb_false_iff, andb_true_iff in A. destruct A as [A _].
    rewrite forallb_forall in A. apply A. exact (nth_error_In _ _ G). }
  rewrite X1, X2, (strays_none _ _ _ _ _ HS K). exact (IH k (E x) v J).
Qed.

(** Two points keep their distance but for how far both are off, seen from one frame. *)
Lemma seen_together c u v X X' Y Y' : (c <= length (frames w))%nat -> seen_from s P P' c u X X' -> seen_from s P P' c v Y Y' ->
  exists r, 0 <= r /\ below_opt (upper_plus u v) s r /\ norm (sub X Y) - r <= norm (sub X' Y').
Proof.
  intros L (z & z' & Z1 & Z2 & Bz) (y & y' & Y1 & Y2 & By). destruct (frames_isometric c c (le_n _) L) as [I I'].
  exists (norm (sub z' z) + norm (sub y' y)). pose proof (norm_nonneg (sub z' z)). pose proof (norm_nonneg (sub y' y)).
  split; [lra|]. split; [apply below_plus; assumption|].
  rewrite Z1, Z2, Y1, Y2, (I _ _), (I' _ _).
  pose proof (triangle_of z z' y) as T1. pose proof (triangle_of z' y' y) as T2.
  assert (SW : norm (sub z z') = norm (sub z' z)) by (apply norm_of_dots; destruct z, z'; coords; ring). lra.
Qed.
End Frames.
